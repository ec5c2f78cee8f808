#include "renderer_impl.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "light.h"
#include "shaders/lighting.h"
#include "shaders/mesh.h"
#include "shaders/overlay.h"
#include "shapes.h"
#include "softpoint/core/error.h"
#include "srgb.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

int add_unit_shape(MeshStore& meshes, const TriangleMesh& mesh) {
  return meshes.add(SmoothMesh(mesh.vertices, mesh.triangles, 40.0));
}

std::string describe_driver(const GlApi& gl) {
  const auto text = [&](GLenum name) {
    const GLubyte* bytes = gl.GetString(name);
    return std::string(bytes ? reinterpret_cast<const char*>(bytes) : "unknown");
  };
  return text(GL_RENDERER) + ", " + text(GL_VERSION);
}

}  // namespace

Renderer::Impl::Impl(const RenderSettings& render_settings)
    : settings((check(render_settings), render_settings)),
      context(make_gl_context(settings.backend)),
      gl(*context),
      driver(describe_driver(gl)),
      framebuffer(gl, settings.width, settings.height, settings.samples),
      shadow_map(gl, settings.shadow_resolution),
      meshes(gl),
      ground_painter(gl),
      overlay(gl),
      arrow_shaft(add_unit_shape(meshes, unit_cylinder(20))),
      arrow_head(add_unit_shape(meshes, unit_cone(24))),
      mesh_program_(gl, "mesh", kMeshVertex, kMeshFragment, kLighting),
      shadow_program_(gl, "shadow", kShadowVertex, kShadowFragment),
      sky_program_(gl, "sky", kSkyVertex, kSkyFragment),
      instance_buffer_(gl) {
  gl.GenBuffers(1, &block_buffer_);
  gl.BindBuffer(GL_UNIFORM_BUFFER, block_buffer_);
  gl.BufferData(GL_UNIFORM_BUFFER, sizeof(FrameBlock), nullptr, GL_STREAM_DRAW);
  gl.GenVertexArrays(1, &empty_array_);
  context->release();
}

Renderer::Impl::~Impl() {
  // A context that cannot be made current leaves nothing we could free one by one; it takes all with it.
  try {
    context->make_current();
  } catch (const Error&) {
  }
  gl.DeleteBuffers(1, &block_buffer_);
  gl.DeleteVertexArrays(1, &empty_array_);
}

void Renderer::Impl::begin(const Camera& new_camera) {
  check(new_camera);
  camera = new_camera;
  view = View(camera, settings.width, settings.height);
  to_light = direction_to_light(settings, view.world_up);
  draws_.clear();
  overlay.clear();
  grounds.clear();
  texts_.clear();
  letters_.clear();
  stats = {};
  in_frame = true;
}

void Renderer::Impl::require_frame(const char* call) const {
  if (!in_frame) throw Error(std::string(call) + ": permitted between begin() and finish() only");
}

void Renderer::Impl::add_mesh_draw(int mesh, const Material& material, const Pose& pose) {
  const SmoothMesh& shape = meshes.at(mesh);
  const auto within = [](const auto& m) { return m.allFinite() && m.cwiseAbs().maxCoeff() <= kFarthest; };
  if (!shape.finite() || !within(pose.linear) || !within(pose.origin)) {
    ++stats.skipped_not_finite;
    return;
  }
  MeshDraw draw;
  draw.mesh = mesh;
  draw.two_sided = material.two_sided;
  draw.casts_shadow = material.casts_shadow;
  draw.wireframe = material.wireframe;
  const Box& bounds = shape.bounds();
  draw.box.center = pose.linear * bounds.center + pose.origin;
  for (std::size_t i = 0; i < 3; ++i) draw.box.half[i] = pose.linear * bounds.half[i];
  const Vec3 origin = pose.origin - view.eye;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) draw.instance.rows[4 * r + c] = static_cast<float>(pose.linear(r, c));
    draw.instance.rows[4 * r + 3] = static_cast<float>(origin[r]);
  }
  const double linear[4] = {decode_srgb(material.color.r), decode_srgb(material.color.g),
                            decode_srgb(material.color.b), std::clamp(material.roughness, 0.05, 1.0)};
  for (int c = 0; c < 4; ++c) draw.instance.color_roughness[c] = static_cast<float>(linear[c]);
  draw.instance.wetness = static_cast<float>(std::clamp(material.wetness, 0.0, 1.0));
  draws_.add(draw);
}

void Renderer::Impl::add_text(double x, double y, std::string_view text, const TextStyle& style) {
  texts_.push_back({x, y, letters_.size(), text.size(), style});
  letters_ += text;
}

Renderer::Impl::Depths Renderer::Impl::choose_depths() const {
  // As close round the scene as the content allows: depth precision goes with near over far.
  Depths depths{0.1 * view.target_distance, 2.0 * view.target_distance};
  for (const MeshDraw& draw : draws_.draws()) {
    if (!view.sees(draw.box)) continue;
    const double middle = (draw.box.center - view.eye).dot(view.forward);
    const double reach = draw.box.reach(view.forward);
    depths.near_depth = std::min(depths.near_depth, 0.98 * (middle - reach));
    depths.far_depth = std::max(depths.far_depth, 1.02 * (middle + reach));
  }
  for (const GroundDraw& ground : grounds) {
    const double height = ground.normal.dot(view.eye) - ground.offset;
    if (height <= 0) continue;
    depths.near_depth = std::min(depths.near_depth, 0.3 * height);
    depths.far_depth = std::max(depths.far_depth, 1.01 * std::hypot(ground_radius(view, height), height));
  }
  depths.near_depth = std::max(depths.near_depth, 2e-3 * view.target_distance);
  return depths;
}

void Renderer::Impl::add_wireframes() {
  for (const MeshDraw& draw : draws_.draws()) {
    if (!draw.wireframe || !view.sees(draw.box)) continue;
    const SmoothMesh& mesh = meshes.drawn(draw.mesh);
    const float* rows = draw.instance.rows;
    const auto place = [&](std::uint32_t i) {
      const Vec3 p = mesh.position(i);
      Vec3 out;
      for (int r = 0; r < 3; ++r) {
        out[r] = rows[4 * r] * p.x() + rows[4 * r + 1] * p.y() + rows[4 * r + 2] * p.z() + rows[4 * r + 3];
      }
      return out;
    };
    for (const auto& [a, b] : mesh.edges()) {
      overlay.add_line(place(a), place(b), {0.08F, 0.09F, 0.12F, 0.55F}, 1.1, false);
    }
  }
}

void Renderer::Impl::fill_block(const Depths& depths, const ShadowFit& fit) {
  fill_light(block_, view, settings, to_light);
  block_.ray_up[3] = static_cast<float>(depths.near_depth);
  const Matrix4f projection = view.projection(depths.near_depth, depths.far_depth);
  std::memcpy(block_.projection, projection.data(), sizeof block_.projection);
  block_.to_light[3] = fit.empty ? 0.0F : 1.0F;
  if (!fit.empty) {
    const Matrix4f shadow = shadow_matrix(fit, to_light);
    std::memcpy(block_.shadow, shadow.data(), sizeof block_.shadow);
    const double texel = 1.0 / settings.shadow_resolution;
    const double radius = std::max(settings.shadow_softness, 1.5 * texel);
    block_.shadow_shape[0] = static_cast<float>(radius);
    block_.shadow_shape[1] = static_cast<float>(1.5 * texel * fit.side);
    block_.shadow_shape[2] = static_cast<float>(radius * fit.side);
  }
  gl.BindBuffer(GL_UNIFORM_BUFFER, block_buffer_);
  gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof block_, &block_);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, block_buffer_);
}

void Renderer::Impl::upload() {
  for (const std::vector<Run>* runs : {&seen_runs_, &caster_runs_}) {
    for (const Run& run : *runs) stats.meshes_uploaded += meshes.upload(run.mesh) ? 1 : 0;
  }
  instance_buffer_.fill(instances_);
}

void Renderer::Impl::draw_runs(const std::vector<Run>& runs, bool cull_backs) const {
  for (const Run& run : runs) {
    if (cull_backs) (run.two_sided ? gl.Disable : gl.Enable)(GL_CULL_FACE);
    meshes.draw(run.mesh, instance_buffer_.id(), run.first, run.count);
  }
}

void Renderer::Impl::draw_shadow_map() const {
  shadow_map.begin();
  shadow_program_.use();
  draw_runs(caster_runs_, false);
  shadow_map.end();
}

void Renderer::Impl::draw_scene() {
  framebuffer.bind();
  shadow_map.bind_texture();
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_BLEND);
  gl.CullFace(GL_BACK);
  const Color& plain = settings.background;
  gl.ClearColor(plain.r, plain.g, plain.b, 1.0F);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  mesh_program_.use();
  draw_runs(seen_runs_, true);
  gl.Disable(GL_CULL_FACE);
  const double spacing = !settings.grid              ? 0.0
                         : settings.grid_spacing > 0 ? settings.grid_spacing
                                                     : automatic_spacing(view);
  for (const GroundDraw& ground : grounds) {
    const double height = ground.normal.dot(view.eye) - ground.offset;
    ground_painter.draw(view, ground, spacing, ground_radius(view, height));
  }
  if (settings.sky) {
    // Last, so that it is shaded only where nothing else stands.
    gl.DepthFunc(GL_LEQUAL);
    sky_program_.use();
    gl.BindVertexArray(empty_array_);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.DepthFunc(GL_LESS);
  }
  overlay.draw();
}

void Renderer::Impl::finish(Image& image) {
  require_frame("finish");
  const CurrentContext current(*context);
  const Depths depths = choose_depths();
  draws_.sort();
  instances_.clear();
  draws_.gather(instances_, seen_runs_, [this](const MeshDraw& draw) {
    const bool seen = view.sees(draw.box);
    ++(seen ? stats.meshes_drawn : stats.meshes_culled);
    if (seen) stats.triangles_drawn += meshes.drawn(draw.mesh).triangle_count();
    return seen;
  });
  ShadowFit fit;
  caster_runs_.clear();
  if (settings.shadows) {
    fit = fit_shadow(view, to_light, draws_.draws(), depths.far_depth, settings.shadow_resolution);
    draws_.gather(instances_, caster_runs_, [&](const MeshDraw& draw) {
      if (!draw.casts_shadow) return false;
      const bool casts = !fit.empty && view.sees_shadow(draw.box, -to_light) && touches(fit, view, draw.box);
      ++(casts ? stats.casters_drawn : stats.casters_culled);
      return casts;
    });
  }
  add_wireframes();
  upload();
  fill_block(depths, fit);
  if (!fit.empty) draw_shadow_map();
  draw_scene();

  image.width = settings.width;
  image.height = settings.height;
  image.rgba.resize(4 * static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height));
  framebuffer.read(image.rgba);
  draw_texts(image);
  meshes.release_removed();
  last_stats = stats;
  in_frame = false;
}

void Renderer::Impl::draw_texts(Image& image) const {
  const std::string_view letters = letters_;
  for (const Text& text : texts_) {
    picture::draw_text(image, static_cast<int>(std::lround(text.x)), static_cast<int>(std::lround(text.y)),
                       letters.substr(text.first, text.length), text.style);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

#include "shadow.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double middle, double reach) {
    low = std::min(low, middle - reach);
    high = std::max(high, middle + reach);
  }
  bool meets(const Range& other) const { return low <= other.high && other.low <= high; }
  void cut(const Range& other) {
    low = std::max(low, other.low);
    high = std::min(high, other.high);
  }
};

// What the camera sees up to `far_depth`, along one direction.
Range seen_along(const View& view, const Vec3& direction, double far_depth) {
  Range range;
  range.add(0, 0);
  const double reach =
      view.tan_x * std::abs(view.right.dot(direction)) + view.tan_y * std::abs(view.up.dot(direction));
  range.add(far_depth * view.forward.dot(direction), far_depth * reach);
  return range;
}

}  // namespace

ShadowFit fit_shadow(const View& view, const Vec3& to_light, std::span<const MeshDraw> casters,
                     double far_depth, int resolution) {
  ShadowFit fit;
  const auto [axis_u, axis_v] = tangents(to_light);
  fit.axis_u = axis_u;
  fit.axis_v = axis_v;
  const Range seen_u = seen_along(view, axis_u, far_depth), seen_v = seen_along(view, axis_v, far_depth);
  Range u, v, depth;
  for (const MeshDraw& caster : casters) {
    if (!caster.casts_shadow || !view.sees_shadow(caster.box, -to_light)) continue;
    const Vec3 center = caster.box.center - view.eye;
    Range own_u, own_v;
    own_u.add(center.dot(axis_u), caster.box.reach(axis_u));
    own_v.add(center.dot(axis_v), caster.box.reach(axis_v));
    if (!own_u.meets(seen_u) || !own_v.meets(seen_v)) continue;
    own_u.cut(seen_u);
    own_v.cut(seen_v);
    u.add(0.5 * (own_u.low + own_u.high), 0.5 * (own_u.high - own_u.low));
    v.add(0.5 * (own_v.low + own_v.high), 0.5 * (own_v.high - own_v.low));
    depth.add(-center.dot(to_light), caster.box.reach(to_light));
    fit.empty = false;
  }
  if (fit.empty) return fit;

  // A margin for the filter's radius and the snapping, then the next step of 2^(1/4).
  const double extent = std::max({u.high - u.low, v.high - v.low, 1e-6}) * 1.06;
  fit.side = std::exp2(std::ceil(4.0 * std::log2(extent)) / 4.0);
  const double texel = fit.side / resolution;
  const auto snap = [&](const Range& range, const Vec3& axis) {
    const double eye = view.eye.dot(axis);
    return std::round((0.5 * (range.low + range.high) + eye) / texel) * texel - eye;
  };
  fit.middle_u = snap(u, axis_u);
  fit.middle_v = snap(v, axis_v);
  const double slack = 0.01 * (depth.high - depth.low) + 4 * texel;
  fit.nearest = depth.low - slack;
  fit.farthest = depth.high + slack;
  return fit;
}

Matrix4f shadow_matrix(const ShadowFit& fit, const Vec3& to_light) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 0) = fit.axis_u.transpose() / fit.side;
  m(0, 3) = 0.5 - fit.middle_u / fit.side;
  m.block<1, 3>(1, 0) = fit.axis_v.transpose() / fit.side;
  m(1, 3) = 0.5 - fit.middle_v / fit.side;
  const double depth = fit.farthest - fit.nearest;
  m.block<1, 3>(2, 0) = -to_light.transpose() / depth;
  m(2, 3) = -fit.nearest / depth;
  return m.cast<float>();
}

bool touches(const ShadowFit& fit, const View& view, const Box& box) {
  const Vec3 center = box.center - view.eye;
  const double half = 0.5 * fit.side;
  return std::abs(center.dot(fit.axis_u) - fit.middle_u) <= half + box.reach(fit.axis_u) &&
         std::abs(center.dot(fit.axis_v) - fit.middle_v) <= half + box.reach(fit.axis_v);
}

ShadowMap::ShadowMap(const GlApi& gl, int resolution) : gl_(gl), resolution_(resolution) {
  gl.GenTextures(1, &texture_);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, texture_);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, resolution, resolution, 0, GL_DEPTH_COMPONENT,
                GL_UNSIGNED_INT, nullptr);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  gl.GenFramebuffers(1, &framebuffer_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
  gl.DrawBuffer(GL_NONE);
  gl.ReadBuffer(GL_NONE);
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    gl.DeleteFramebuffers(1, &framebuffer_);
    gl.DeleteTextures(1, &texture_);
    throw Error("shadow_resolution = " + std::to_string(resolution) +
                ": the driver has no such depth texture");
  }
}

ShadowMap::~ShadowMap() {
  gl_.DeleteFramebuffers(1, &framebuffer_);
  gl_.DeleteTextures(1, &texture_);
}

void ShadowMap::begin() const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.Viewport(0, 0, resolution_, resolution_);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_CULL_FACE);
  gl_.Enable(GL_POLYGON_OFFSET_FILL);
  gl_.PolygonOffset(1.5F, 2.0F);
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
}

void ShadowMap::end() const { gl_.Disable(GL_POLYGON_OFFSET_FILL); }

void ShadowMap::bind_texture() const {
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, texture_);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "draw_list.h"
#include "frame_block.h"
#include "gl/api.h"
#include "gl/context.h"
#include "gl/framebuffer.h"
#include "gl/program.h"
#include "gl/stream_buffer.h"
#include "ground.h"
#include "overlay.h"
#include "shadow.h"
#include "softpoint/picture/renderer.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Throws Error naming the field.
void check(const RenderSettings& settings);

class __attribute__((visibility("hidden"))) Renderer::Impl {
 public:
  explicit Impl(const RenderSettings& render_settings);
  ~Impl();

  struct Text {
    double x, y;
    std::size_t first, length;  // in `letters`
    TextStyle style;
  };

  void begin(const Camera& new_camera);
  void require_frame(const char* call) const;
  void add_mesh_draw(int mesh, const Material& material, const Pose& pose);
  void add_text(double x, double y, std::string_view text, const TextStyle& style);
  void finish(Image& image);

  RenderSettings settings;
  std::unique_ptr<GlContext> context;  // current while what follows is built and torn down
  GlApi gl;
  std::string driver;
  Framebuffer framebuffer;
  ShadowMap shadow_map;
  MeshStore meshes;
  GroundPainter ground_painter;
  Overlay overlay;
  int arrow_shaft, arrow_head;

  Camera camera;
  View view;
  Vec3 to_light{0, 1, 0};
  bool in_frame = false;
  RenderStats stats, last_stats;
  std::vector<GroundDraw> grounds;

 private:
  struct Depths {
    double near_depth, far_depth;
  };

  Depths choose_depths() const;
  void add_wireframes();
  void fill_block(const Depths& depths, const ShadowFit& fit);
  void upload();
  void draw_runs(const std::vector<Run>& runs, bool cull_backs) const;
  void draw_shadow_map() const;
  void draw_scene();
  void draw_texts(Image& image) const;

  Program mesh_program_, shadow_program_, sky_program_;
  StreamBuffer instance_buffer_;
  GLuint block_buffer_ = 0, empty_array_ = 0;
  FrameBlock block_{};
  DrawList draws_;
  std::vector<MeshInstance> instances_;  // scratch of finish()
  std::vector<Run> seen_runs_, caster_runs_;
  std::vector<Text> texts_;
  std::string letters_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

#pragma once

#include <span>
#include <vector>

#include "draw_list.h"
#include "frame_block.h"
#include "gl/api.h"
#include "view.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// The square of a plane across the light that the shadow map covers, and the depths it spans.
struct ShadowFit {
  Vec3 axis_u{1, 0, 0}, axis_v{0, 1, 0};  // unit, across the light
  double middle_u = 0, middle_v = 0;      // relative to the eye, metres
  double side = 1;                        // metres
  double nearest = 0, farthest = 1;       // along the travel of the light, relative to the eye, metres
  bool empty = true;                      // nothing throws a shadow into the picture
};

// Covers the casters as far as their shadows can fall into the picture up to `far_depth` metres from the eye.
// Side and middle move in coarse steps only, so that the texels stand still while things move.
ShadowFit fit_shadow(const View& view, const Vec3& to_light, std::span<const MeshDraw> casters,
                     double far_depth, int resolution);

// From eye-relative coordinates to texture coordinates and depth, each 0 to 1.
Matrix4f shadow_matrix(const ShadowFit& fit, const Vec3& to_light);

// Does `box` (world) touch the square?
bool touches(const ShadowFit& fit, const View& view, const Box& box);

// A depth texture drawn from the light.
class ShadowMap {
 public:
  ShadowMap(const GlApi& gl, int resolution);
  ShadowMap(const ShadowMap&) = delete;
  ShadowMap& operator=(const ShadowMap&) = delete;
  ~ShadowMap();

  // Clears the map and makes it the target of what is drawn next.
  void begin() const;
  void end() const;
  // Puts the map where the shaders look for it.
  void bind_texture() const;

 private:
  const GlApi& gl_;
  int resolution_;
  GLuint framebuffer_ = 0, texture_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

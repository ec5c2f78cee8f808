#pragma once

#include <vector>

#include "softpoint/picture/renderer.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// A small picture that shows one thing the renderer does: the same for every backend, run and precision.
struct PictureScene {
  const char* name;
  RenderSettings settings;
  void (*draw)(Renderer& renderer);  // begin() to all but finish()
};

// "small_scene" (a bit of everything), "shadow", "edges" (4 samples a pixel), "text", "ground", "lines", "wet", "world" (Bullet's).
const std::vector<PictureScene>& picture_scenes();

inline Image render(const PictureScene& scene, Renderer& renderer) {
  scene.draw(renderer);
  return renderer.finish();
}

// So that a test's output names the scene.
inline void PrintTo(const PictureScene& scene, std::ostream* out) { *out << scene.name; }

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

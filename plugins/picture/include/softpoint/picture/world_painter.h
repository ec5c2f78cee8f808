#pragma once

#include <memory>

#include "softpoint/picture/renderer.h"

class btCollisionObject;
class btCollisionWorld;

namespace softpoint::inline SOFTPOINT_ABI::picture {

// What the last draw() took.
struct WorldStats {
  int objects = 0;              // in the world
  int objects_skipped = 0;      // neither they nor their shadows can show: nothing was done for them
  int shapes_tessellated = 0;   // turned into triangles, because they are new or were changed
  int soft_bodies_moved = 0;    // whose vertices were sent anew
  int soft_bodies_at_rest = 0;  // drawn from what was sent before
  int shapes_kept = 0;          // tessellations held ready for the next frame
};

// Draws any Bullet world, stock objects and foreign ones alike, from its collision shapes, and soft bodies
// from their faces (from their links without faces, from their nodes without links). A static plane becomes
// an unbounded floor seen from its front. Objects are drawn where their world transforms say, not
// interpolated.
//
// Things that never move are grey, each other object gets a palette colour in the order it is first met.
// Objects without contact response (sensors, ghosts) stay out of the picture until they are given a material
// or made visible.
class SOFTPOINT_API WorldPainter {
 public:
  // Keeps its meshes in `renderer`, which must outlive it.
  explicit WorldPainter(Renderer& renderer);
  WorldPainter(const WorldPainter&) = delete;
  WorldPainter& operator=(const WorldPainter&) = delete;
  ~WorldPainter();

  // Between renderer.begin() and renderer.finish(). Changes nothing in the world. Shapes are tessellated once
  // and kept until they change or go unseen for some hundred calls.
  void draw(const btCollisionWorld& world);

  // Looks that overrule the defaults until forget(). The object is told by its address, so forget one that
  // is deleted.
  void set_material(const btCollisionObject& object, const Material& material);
  // Leaves it out of the picture, or puts it in.
  void set_visible(const btCollisionObject& object, bool visible);
  // Back to the defaults; also for an object that is deleted.
  void forget(const btCollisionObject& object);
  // How `object` is drawn: as set, or by default. Gives it its palette colour if it has none yet.
  Material material(const btCollisionObject& object);

  const WorldStats& stats() const;  // of the last draw()

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include <memory>
#include <vector>

#include "facet_sheets.h"
#include "shape_features.h"

namespace softpoint::inline SOFTPOINT_ABI {

// The triangles of meshes and height fields that lie near a deformable, with their corners and edges. A patch
// reaches somewhat farther than it is asked for and is kept until that no longer suffices.
class MeshPatches {
 public:
  void begin_substep();
  // The triangles of `shape` (child `child` of `object`) within `region` (its frame) and some of their
  // surroundings. `fresh` tells that the patch was made anew, so that indices of its features have changed.
  const ColliderShape& get(int body, const btCollisionObject& object, int child, const btConcaveShape& shape,
                           const Bounds& region, bool& fresh);
  // Forget what a shape looked like.
  void forget(const btCollisionShape& shape);
  void forget_body(int body);
  void clear() { entries_.clear(); }
  // Those of a body that sleeps are in use.
  void keep(int body);

 private:
  struct Entry {
    int body = 0;
    const btCollisionObject* object = nullptr;
    int child = 0;
    const btConcaveShape* shape = nullptr;
    Bounds region;  // all triangles in here are in the patch
    Vec3 scaling = Vec3::Ones();
    Vec3 bounds_low = Vec3::Zero(), bounds_high = Vec3::Zero();  // of the whole shape
    long long last_used = 0;
    std::unique_ptr<ColliderShape> patch;  // stays where it is while entries move
  };

  long long substep_ = 0;
  std::vector<Entry> entries_;
  FacetSheets sheets_;
  FeatureWorkspace work_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI

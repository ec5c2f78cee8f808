#pragma once

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision_object.h>

#include "softpoint/figure/figure_collision.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace figure_collision_parts {

using Object = fcl::CollisionObject<double>;

// A box of the broad phase, never turned: FCL puts a loose cube around what is.
struct Proxy {
  explicit Proxy(int which)
      : index(which),
        box(std::make_shared<fcl::Box<double>>(1, 1, 1)),
        object(std::make_unique<Object>(box)) {
    object->setUserData(this);
  }
  void set(const Vec3& low, const Vec3& high) {
    box->side = high - low;
    box->computeLocalAABB();
    object->setTranslation(0.5 * (low + high));
    object->computeAABB();
  }
  int index;
  std::shared_ptr<fcl::Box<double>> box;
  std::unique_ptr<Object> object;
};

struct Placed {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
};

}  // namespace figure_collision_parts
using figure_collision_parts::Object;
using figure_collision_parts::Placed;
using figure_collision_parts::Proxy;

struct __attribute__((visibility("hidden"))) FigureCollision::Impl {
  Impl(std::vector<LinkCapsule> shapes, std::vector<Obstacle> things)
      : capsules(std::move(shapes)), obstacles(std::move(things)), placed(capsules.size()) {}

  void set_boxes(double reach);
  void test(int capsule, int obstacle, double reach);
  void test_pair(int capsule, int other, double reach);
  void test_plane(int capsule, const Obstacle& plane, int index, double reach);
  void test_box(int capsule, const Obstacle& box, int index, double reach);
  void test_mesh(int capsule, const Obstacle& mesh, int index, double reach);
  void keep(int capsule, int obstacle, int other, double along, double distance, const Vec3& normal,
            double reach);
  Vec3 point_of(int capsule, double along) const {
    const Placed& p = placed[static_cast<std::size_t>(capsule)];
    return p.from + along * (p.to - p.from);
  }
  void place_obstacle(std::size_t index);

  std::vector<LinkCapsule> capsules;
  std::vector<Obstacle> obstacles;
  std::vector<std::pair<int, int>> pairs;  // of capsules
  std::vector<Placed> placed;
  std::vector<Touch> touches;
  Counts counts;
  std::vector<std::unique_ptr<Proxy>> moving, standing;
  fcl::DynamicAABBTreeCollisionManager<double> moving_tree, standing_tree;
  std::vector<std::pair<int, int>> overlapping;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

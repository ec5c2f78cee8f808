#pragma once

#include <vector>

#include "scene.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A convex solid by its plain geometry, in doubles: mass properties for the making of bodies, and depths
// for measuring penetration independently of any collision code.
class ConvexSolid {
 public:
  // Of any shape but a mesh or a compound. Throws Error for a hull without volume.
  explicit ConvexSolid(const ShapeSpec& shape);

  // How deep `local` (m, in the frame of the shape) lies inside, to the nearest point of the surface.
  // Negative outside, by no more than the distance.
  double depth(const Vec3& local) const;

  double volume() const { return volume_; }                      // m3; infinite for a plane
  const Vec3& center() const { return center_; }                 // of mass, m
  const std::vector<Vec3>& corners() const { return corners_; }  // of boxes and hulls, m
  // No point of it is farther from the frame's origin; infinite for a plane.
  double reach() const { return reach_; }

 private:
  struct Plane {
    Vec3 normal;
    double offset;
  };
  void build_hull();

  ShapeSpec shape_;
  std::vector<Vec3> corners_;
  std::vector<Plane> planes_;  // of a hull
  Vec3 center_ = Vec3::Zero();
  double volume_ = 0, reach_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

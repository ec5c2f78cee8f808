#pragma once

#include "contact.h"
#include "softpoint/core/deformable.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Finds the contacts of one deformable with placed shapes in the configuration that the end of the step
// would have, so that what the solver separates stays separated after Bullet has integrated.
class ContactFinder {
 public:
  // Face and edge bounds of the end configuration; once a pass, when a shape with corners is near.
  void begin_pass(const Deformable& body);

  void find_vertices(int body_index, const Deformable& body, const ShapeInstance& shape,
                     const RigidState& rigid, double margin, ContactTable& contacts);
  void find_corners(int body_index, const Deformable& body, const ShapeInstance& shape,
                    const RigidState& rigid, double margin, ContactTable& contacts);
  void find_edges(int body_index, const Deformable& body, const ShapeInstance& shape, const RigidState& rigid,
                  double margin, ContactTable& contacts);

 private:
  struct Bounds {
    Vec3 low, high;
    bool misses(const Vec3& a, const Vec3& b, double reach) const {
      return (low - a.cwiseMax(b)).maxCoeff() > reach || (a.cwiseMin(b) - high).maxCoeff() > reach;
    }
  };
  struct SkinPoint {
    int face = -1;
    Vec3 weights = Vec3::Zero();
    Vec3 outward = Vec3::UnitY();
    double distance = 0;  // m, negative inside
  };

  bool crossed_face(const Deformable& body, const Vec3& from, const Vec3& to, SkinPoint& hit) const;
  bool nearest_face(const Deformable& body, const Vec3& p, double reach, SkinPoint& nearest) const;
  Vec3 face_normal(const Deformable& body, int face) const;

  std::vector<Bounds> face_bounds_;
  Bounds body_bounds_{Vec3::Zero(), Vec3::Zero()};
};

}  // namespace softpoint::inline SOFTPOINT_ABI

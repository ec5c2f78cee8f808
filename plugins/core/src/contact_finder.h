#pragma once

#include "contact.h"
#include "softpoint/core/deformable.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Features up to this many margins beyond the margin become candidates: other contacts may push them in.
inline constexpr double kSlackMargins = 3.0;
// Below this depth (m) the nearest surface point at the end of the step may be on the wrong side, so the path
// of the step is followed to the point of entry instead.
inline constexpr double kTrustedDepth = 5e-3;
// Normals whose cosine is below this belong to different sides of a shape.
inline constexpr double kSameSide = 0.7;

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
  void find_faces(int body_index, const Deformable& body, const ShapeInstance& shape, const RigidState& rigid,
                  double margin, bool at_start, ContactTable& contacts);
  // With `at_start`, edge pairs are taken as they stand at the start of the step, from where they approach.
  void find_edges(int body_index, const Deformable& body, const ShapeInstance& shape, const RigidState& rigid,
                  double margin, bool at_start, ContactTable& contacts);

  // A contact of an earlier pass of this substep that detection did not find again: measured anew on the
  // same features, so that what one pass separated does not fall back in the next. False when the features
  // have left each other.
  bool refresh(const Deformable& body, const ShapeInstance& shape, const RigidState& rigid, double margin,
               Contact& contact) const;

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

  static bool sample_face(const Deformable& body, const Triangle& face, const ColliderShape& shape,
                          const Pose& pose, Vec3& weights, Vec3& normal, double& distance);
  static void follow_face(const Deformable& body, const ShapeInstance& shape, const RigidState& rigid,
                          double margin, Contact& contact);
  struct EdgePair {
    double s = 0, t = 0;  // parameters on the rigid edge and the skin's edge
    Vec3 normal = Vec3::UnitY();
    double gap = 0;  // m, without radius and margin
  };

  bool measure_edges(const Deformable& body, const std::vector<Vec3>& points, const ShapeEdge& edge,
                     const Pose& pose, int skin_edge, EdgePair& pair) const;
  static void place_on_face(const Deformable& body, int face, const Vec3& weights, const RigidState& rigid,
                            Contact& contact);
  static bool segment_meets_front(const Deformable& body, int face, const Vec3& from, const Vec3& d,
                                  double& time, Vec3& weights);
  bool crossed_face(const Deformable& body, const Vec3& from, const Vec3& to, SkinPoint& hit) const;
  bool nearest_face(const Deformable& body, const Vec3& p, double reach, SkinPoint& nearest) const;
  Vec3 press_direction(const Deformable& body, const SkinPoint& skin, const ColliderShape& shape,
                       std::size_t corner, const Pose& pose) const;
  bool skin_along(const Deformable& body, const Vec3& corner, const Vec3& direction, double reach,
                  SkinPoint& hit) const;
  bool inside(const Deformable& body, const Vec3& p) const;
  Vec3 face_normal(const Deformable& body, const std::vector<Vec3>& points, int face) const;

  std::vector<Bounds> face_bounds_;
  std::vector<Vec3> normals_;  // of the skin at its points
  double step_travel_ = 0;     // m, farthest any point moves over the step
  Bounds body_bounds_{Vec3::Zero(), Vec3::Zero()};
};

}  // namespace softpoint::inline SOFTPOINT_ABI

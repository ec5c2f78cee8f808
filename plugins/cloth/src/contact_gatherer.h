#pragma once

#include <span>
#include <vector>

#include "cloth_solver.h"
#include "softpoint/core/near_colliders.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Turns what is near a cloth into at most two contact planes a point, and the nearest surface of every point
// for the air. Planes are made once a frame, with room for the motion to come; those of curved or moving
// surfaces follow their points in between.
class ContactGatherer {
 public:
  struct Points {
    std::span<const Vec3> positions;          // m, world
    std::span<const double> friction_factor;  // one a point
  };
  struct Reach {
    double half_thickness = 0;  // m, kept between points and colliders
    double motion = 0;          // m, that points may move against colliders in the frame
    double air = 0;             // m, up to which feet are wanted; 0: none
  };

  explicit ContactGatherer(std::size_t points);

  // At the start of a frame, or within it when points have moved farther than foreseen.
  void gather(const NearColliders& near, const Points& points, const Reach& reach);
  // Before the film's pull is known in full: the adhesion of each point, N.
  void set_adhesion(std::span<const double> adhesion);
  // Within a frame: planes of surfaces that curve or move, at the points' present positions. Whether any has
  // changed.
  bool follow(const NearColliders& near, const Points& points);
  // Whether some point has moved farther than the frame was gathered for.
  bool outrun(std::span<const Vec3> positions) const;

  std::span<const PointContacts> contacts() const { return contacts_; }
  // Points with a plane that can change within the frame.
  std::span<const int> moving() const { return moving_; }
  const Reach& reach() const { return reach_; }
  int planes() const { return planes_; }
  int queries() const { return queries_; }

  // For the air, per point: nearest surface, gap beyond the thickness (0 in contact, infinite out of reach)
  // and the collider it is of (-1: none).
  std::span<const Vec3> feet() const { return feet_; }
  std::span<const Vec3> normals() const { return normals_; }
  std::span<const double> gaps() const { return gaps_; }
  std::span<const int> colliders() const { return colliders_; }

 private:
  struct Slot {
    int piece = -1;
    Vec3 asked_at = Vec3::Zero();  // m, in the collider's frame
  };
  void visit(const NearColliders& near, int piece, int point, const Vec3& at, double gap, const Vec3& normal);
  void set_plane(const NearColliders& near, int piece, int point, const Vec3& at, double gap,
                 const Vec3& normal, ContactPlane& plane) const;

  Reach reach_;
  std::vector<PointContacts> contacts_;
  std::vector<std::array<Slot, 2>> slots_;
  std::vector<std::array<double, 2>> plane_gaps_;
  std::vector<Vec3> feet_, normals_, gathered_at_;
  std::vector<double> gaps_, friction_, adhesion_;
  std::vector<int> colliders_, candidates_, moving_;
  int planes_ = 0;
  int queries_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

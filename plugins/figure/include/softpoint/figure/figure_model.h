#pragma once

#include <string>
#include <vector>

#include "softpoint/core/config.h"
#include "softpoint/core/vec.h"
#include "softpoint/figure/joint_kind.h"

// Articulated figures: trees of rigid links.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// rad: half angles of a ball's cone, and its twist either way. A swing of pi has no twist, nor a direction.
inline constexpr double kLeastSwing = 0.01, kMostSwing = 3.0, kMostTwist = 3.0;

// A rigid body and the joint that ties it to its parent. The link's frame has its origin at that joint; at q
// = 0 its axes are those of the parent turned by `orientation`.
struct Link {
  std::string name;
  int parent = -1;  // index of an earlier link; -1 is the world
  JointKind joint = JointKind::kHinge;
  Vec3 axis = Vec3::UnitZ();   // hinge, prismatic, a ball's twist: in the link's frame; made a unit vector
  Vec3 origin = Vec3::Zero();  // m, of the joint, in the parent's frame
  Mat3 orientation = Mat3::Identity();  // of the link's frame in the parent's at q = 0

  double mass = 0;                     // kg; 0 for the inner links of chained hinges
  Vec3 center_of_mass = Vec3::Zero();  // m, in the link's frame
  Mat3 inertia = Mat3::Zero();         // kg m2, about the centre of mass, axes of the link's frame

  double lower = -1e9, upper = 1e9;  // rad or m, of a hinge or prismatic joint; of the twist of a ball
  // A ball's turn is a twist about `axis` and then a swing, a turn about an axis across it (swing_twist.h).
  // The swing stays in an elliptic cone of these half angles (rad, kLeastSwing to kMostSwing; both at 1e9:
  // any swing) about `swing_axis` (in the link's frame, made a unit vector across `axis`; zero: any of those)
  // and about axis x swing_axis. Only a ball with a cone can have a range of the twist, within kMostTwist.
  double swing_about = 1e9, swing_across = 1e9;
  Vec3 swing_axis = Vec3::Zero();
  double armature = 0;     // kg m2 (kg): inertia of the joint itself, added to the diagonal
  double damping = 0;      // N m s (N s/m): viscous friction
  double friction = 0;     // N m (N), of a hinge or prismatic joint: dry friction
  std::string joint_name;  // empty: the joint is called like the link
};

// A solid circular cylinder along z of the link's frame from 0 to `length` (m): the links of the keyframe
// paper.
SOFTPOINT_API void set_cylinder(Link& link, double mass, double radius, double length);

// A figure that was checked: every link's numbers finite, parents before children, inertias possible for a
// body (principal moments not negative, none above the sum of the others), massless links only where
// something heavy hangs on them. Throws Error naming link, field, value and what is permitted.
class SOFTPOINT_API FigureModel {
 public:
  explicit FigureModel(std::vector<Link> links);

  const std::vector<Link>& links() const { return links_; }
  int link_count() const { return static_cast<int>(links_.size()); }
  int position_count() const { return position_count_; }  // numbers in q
  int velocity_count() const { return velocity_count_; }  // degrees of freedom
  // Where the numbers of a link's joint begin.
  int position_offset(int link) const { return position_offsets_[static_cast<std::size_t>(link)]; }
  int velocity_offset(int link) const { return velocity_offsets_[static_cast<std::size_t>(link)]; }
  // Index of the link of that name; -1 if there is none.
  int find(const std::string& name) const;
  const std::string& joint_name(int link) const;
  double total_mass() const;  // kg

 private:
  std::vector<Link> links_;
  std::vector<int> position_offsets_, velocity_offsets_;
  int position_count_ = 0, velocity_count_ = 0;
};

// Positions and velocities of all joints, laid out as FigureModel says.
struct FigureState {
  std::vector<double> q;
  std::vector<double> qd;
};
// All zero, quaternions one.
SOFTPOINT_API FigureState rest_state(const FigureModel& model);
// Throws Error unless sizes fit, all is finite and no quaternion is zero; makes quaternions unit ones.
SOFTPOINT_API void check_state(const FigureModel& model, FigureState& state);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

#pragma once

#include "joint_solver.h"
#include "skin_layout.h"
#include "softpoint/elastic/assembly.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Parts that hang together, with the state of their joints.
struct GroupState {
  GroupState(const AssemblyDesign& design, const PlacedDesign& placed, int group,
             const std::vector<std::shared_ptr<const PackedModel>>& models, const Kernels& kernels,
             bool single);

  PartGroup group;
  JointSolver solver;
  Eigen::VectorXd x;         // m, the joints' points
  Eigen::VectorXd target;    // m, of held ones
  Eigen::VectorXd skinned;   // m, at which the skin was computed
  Eigen::VectorXd toward;    // m, where inertia would take the points
  Eigen::VectorXd before;    // m, at the start of the step
  Eigen::VectorXd carried;   // m, to where what holds them took the points
  Eigen::VectorXd settled;   // m, from there to where the last solve found them
  Eigen::VectorXd inertia;   // kg/s2, one a point
  std::vector<char> held;    // one a point
  std::vector<Hold> ends;    // of each joint
  double energy = 0;         // J, at the last solve
  bool dragged = false;      // the skin is pushed: parts are slow to leave where they are carried
  bool changed = true;       // something to solve for
  bool solved = false;       // in the last solve
  bool forces_due = false;   // the solver's gradient and the energies are not those of x
  bool factored = false;     // for the present holders
  bool skin_changed = true;  // pushes or gravity, which bend the skin without moving a joint
};

struct __attribute__((visibility("hidden"))) Assembly::Impl {
  Impl(const AssemblyDesign& given, const AssemblySettings& wanted, const Vec3& origin, const Mat3& rotation);

  // The joint of an end, and the group it is in.
  struct Place {
    GroupState* state;
    std::size_t joint;  // of the group
  };
  Place place_of(const PartEnd& end) const;
  Place held_place(const PartEnd& end) const;
  void apply_move(const PartEnd& end, const Vec3& position, const Mat3& turn);
  void solve_group(GroupState& state);
  // Forces and energy of a group that was placed but not solved: found when somebody asks.
  static void find_forces(GroupState& state);
  double carry_along(GroupState& state);
  static void go_on(GroupState& state, double led);
  int predict_bones(GroupState& state);
  void skin(GroupState& state);
  void reserve_skin();
  void add_loads(const PartGroup& group, int segment, const PackedModel& packed, double* u) const;
  void check_end(const PartEnd& end) const;
  void check_kappa(const AssemblySettings& wanted) const;
  // kg of each skin point: a segment's mass on its joint points, and a small part of it on the others.
  std::vector<double> point_masses(double free_part) const;
  double kappa_of(const GroupState& state) const;
  void factor(GroupState& state);

  AssemblyDesign design;
  AssemblySettings settings;
  const Kernels* kernels = nullptr;
  PlacedDesign placed;
  SkinLayout layout;
  std::vector<std::shared_ptr<const PackedModel>> models;
  std::vector<std::unique_ptr<GroupState>> groups;
  std::vector<std::array<int, 2>> joint_places;    // of each placed joint: group, joint there
  std::vector<std::array<int, 2>> segment_places;  // of each placed segment: group, segment there
  std::vector<int> joint_skin;                     // of each placed joint's points, the skin's
  std::vector<int> first_joint_skin;
  Vec3 gravity = Vec3::Zero();
  std::vector<Vec3> points;  // the skin
  AssemblyReport report;
  // Scratch of the skin.
  std::vector<double> sheet, bulge;
  std::vector<int> dirty;
  std::vector<char> shifted;  // one a segment of a group
  std::vector<float> scratch;
  std::vector<Vec3> bone_now, bone_next;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <span>
#include <vector>

#include "bullet_math.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Kinematics of a btMultiBody in double precision: where its links are at the start and, by the rules of
// Bullet's integrator, at the end of a step.
//
// Coordinates as in btMultiBody's velocity vector: angular velocity of the base (world frame), its linear
// velocity, then the joint velocities. Bodies are numbered with the base as 0 and link i as i + 1.
class JointTree {
 public:
  // Reads joint positions and flags. `velocity` holds the coordinate velocities the step ends with as known
  // so far; kinematic bases and links have been put at their end pose already and are rewound by it.
  void read(const btMultiBody& body, std::span<const double> velocity, double dt);

  int coordinates() const { return 6 + dofs_; }
  int bodies() const { return static_cast<int>(links_.size()); }
  int parent(int body) const { return links_[at(body)].parent; }
  int first_dof(int body) const { return links_[at(body)].first_dof; }
  int dof_count(int body) const { return links_[at(body)].dof_count; }
  // Impulses do not change these coordinates: a static or kinematic base, joints of static or kinematic
  // links.
  bool frozen(int body) const { return links_[at(body)].frozen; }
  // Also no velocity: joints that Bullet does not step.
  bool still(int body) const { return links_[at(body)].still; }

  // Centre of mass and orientation at the start of the step.
  const Pose& start(int body) const { return links_[at(body)].start; }
  // Joint axes at the start, world frame: angular and linear velocity (of the body's centre of mass) per
  // unit.
  Vec3 angular_axis(int body, int dof) const { return start(body).rotation * links_[at(body)].top[at(dof)]; }
  Vec3 linear_axis(int body, int dof) const {
    return start(body).rotation * links_[at(body)].bottom[at(dof)];
  }

  // Pose of one body `dt` after the start with these coordinate velocities.
  Pose end(int body, std::span<const double> velocity, double dt) const;

 private:
  struct Link {
    int parent = -1;
    int first_dof = 0;
    int dof_count = 0;
    bool frozen = false, still = false;
    btMultibodyLink::eFeatherstoneJointType joint = btMultibodyLink::eFixed;
    Eigen::Quaterniond zero_rotation = Eigen::Quaterniond::Identity();  // parent frame to this, at q = 0
    Vec3 pivot_to_center = Vec3::Zero(), parent_to_pivot = Vec3::Zero();
    std::array<Vec3, 6> top, bottom;   // joint axes, this frame
    std::array<double, 4> position{};  // at the start
    Pose start;
  };
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  static std::array<double, 4> stepped(const Link& link, const double* velocity, double dt);
  static Pose placed(const Link& link, const Pose& parent, const std::array<double, 4>& position);

  std::vector<Link> links_;
  int dofs_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI

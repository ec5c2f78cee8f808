#pragma once

#include <vector>

#include "joint_tree.h"

namespace softpoint::inline SOFTPOINT_ABI {

// How a btMultiBody answers impulses on some of its links during one substep, in double precision: a push on
// one link changes the velocities of all.
class ArticulatedBody {
 public:
  using Twist = Eigen::Matrix<double, 6, 1, Eigen::DontAlign>;     // linear velocity, angular velocity
  using Response = Eigen::Matrix<double, 6, 6, Eigen::DontAlign>;  // twist per (impulse, its moment)

  // Reads positions and velocities, what Bullet's solver has found but not yet added included.
  void read(btMultiBody& body, double dt);
  btMultiBody* body() const { return body_; }

  // Slot of a link (-1: the base) among the touched ones, made when new.
  int touch(int link);
  int touched() const { return used_; }
  bool movable(int slot) const { return slots_[at(slot)].movable; }
  const Pose& start(int slot) const { return tree_.start(slots_[at(slot)].body); }
  // Velocity of a touched link's centre of mass with all impulses, and with the free ones.
  Twist twist(int slot) const { return twist(slot, change_); }
  Twist free_twist(int slot) const { return twist(slot, free_change_); }
  // Twist of touched link `to` per impulse and moment on touched link `from`.
  const Response& response(int to, int from) const { return responses_[at(to * stride_ + from)]; }

  // Adds the change by an impulse (N s) and its moment (N m s) about the centre of mass of a touched link.
  void push(int slot, const Twist& impulse);
  void push_free(int slot, const Twist& impulse);  // to the free velocities alone
  void restart() { change_ = free_change_; }
  // Where a touched link will be `dt` after the start.
  Pose end(int slot, double dt) const;
  // Adds the change to what Bullet's solver leaves to be added to the velocities, and wakes the body.
  void write_back();
  // Before Bullet's solver has run: the impulses so far act as forces over `dt`, if the world has still to
  // integrate forces, until take_back_forces(); else as velocities.
  void load(bool as_forces, double dt);
  void take_back_forces();

 private:
  struct Slot {
    int body = 0;
    bool movable = false;
    Twist impulse;                                      // N s and N m s, sum of push()
    Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;  // twist per coordinate velocity
    Eigen::Matrix<double, Eigen::Dynamic, 6> answer;    // coordinate velocities per impulse and moment
  };
  Twist twist(int slot, const Eigen::VectorXd& change) const {
    const auto& jacobian = slots_[at(slot)].jacobian;
    return jacobian.lazyProduct(velocity_) + jacobian.lazyProduct(change);
  }
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  void fill_jacobian(int body, Eigen::Matrix<double, 6, Eigen::Dynamic>& jacobian) const;
  void factorize(const btMultiBody& body);
  void wake();
  void add_force(int link, const btVector3& force, const btVector3& torque);
  // Coordinate velocities by generalized impulses, in place.
  void solve(Eigen::Ref<Eigen::VectorXd> coordinates) const;

  btMultiBody* body_ = nullptr;
  JointTree tree_;
  Eigen::VectorXd velocity_, change_, free_change_;
  mutable Eigen::VectorXd end_velocity_;
  std::vector<btScalar> scratch_;
  // Mass matrix, factored as L^T L along the tree; a coordinate that cannot move has no pivot.
  Eigen::MatrixXd factor_;
  Eigen::VectorXd scratch_diagonal_;
  std::vector<int> ancestor_;  // next coordinate towards the base, -1 at its end
  std::vector<char> pivot_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> link_jacobian_;
  std::vector<Slot> slots_;  // the first used_ are touched
  int used_ = 0;
  std::vector<Response> responses_;
  int stride_ = 0;
  struct Lent {  // by load()
    int link;
    btVector3 force, torque;
  };
  std::vector<Lent> lent_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI

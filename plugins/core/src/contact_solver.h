#pragma once

#include <span>

#include "contact.h"
#include "handle_solver.h"
#include "softpoint/core/deformable_system.h"
#include "support_contacts.h"
#include "touched_points.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Impulses between deformables, colliders and handles that make the end of the step free of penetration:
// Signorini's condition and Coulomb's cone per contact, by projected Gauss-Seidel over the exact
// compliance of the touched points.
class ContactSolver {
 public:
  // Forgets the touched points of the last step; every body has predicted its free end positions.
  void begin_step(std::span<Deformable* const> bodies, double dt);
  // Applies the impulses that contacts and handles bring from the last substep, without solving.
  void warm_start(std::span<Deformable* const> bodies, std::vector<Contact>& contacts,
                  std::vector<Handle>& handles, SupportContacts& support, RigidStates& rigid,
                  Profile& profile);
  // Solves one pass for the contacts as detected; leaves end positions and collider velocities updated.
  void solve(std::span<Deformable* const> bodies, std::vector<Contact>& contacts,
             std::vector<Handle>& handles, SupportContacts& support, RigidStates& rigid,
             const ContactSettings& settings, Profile& profile);

 private:
  // A contact ready for sweeping.
  struct Row {
    std::array<int, 3> local{};        // touched points of the body
    std::array<int, 3> other_local{};  // and of the other one, where that is a deformable
    Mat3 compliance;                   // m per N s at the contact
    Vec3 tangent_a, tangent_b;
    double tangent_gain = 0;  // 1 / largest eigenvalue of the tangent block
    double normal_gain = 0;   // 1 / (n . A n)
    Eigen::Matrix<double, 2, 2, Eigen::DontAlign> tangent_inverse;
    double gap_base = 0;            // gap without any motion counted from the free end
    Vec3 slip_base = Vec3::Zero();  // free motion of the contact point over the step
  };

  void collect_touched(std::span<Deformable* const> bodies, const std::vector<Contact>& contacts,
                       const std::vector<Handle>& handles, Profile& profile);
  static void add_side(const Deformable& body, const TouchedPoints& touched, int count,
                       const std::array<int, 3>& points, const std::array<double, 3>& weights, double sign,
                       std::array<int, 3>& local, Row& row);
  void prepare_rows(std::span<Deformable* const> bodies, std::vector<Contact>& contacts,
                    std::vector<Handle>& handles, RigidStates& rigid);
  Vec3 moved(const Contact& contact, const Row& row, const std::vector<Vec3> TouchedPoints::*field) const;
  void add_impulse(const Contact& contact, const Row& row, const Vec3& impulse, RigidStates& rigid);
  static void balance_torques(std::span<Deformable* const> bodies, const std::vector<Contact>& contacts);
  void move_all(std::span<Deformable* const> bodies, const std::vector<Contact>& contacts,
                RigidStates& rigid);
  static Vec3 in_cone(const Contact& contact, const Vec3& impulse);
  double sweep_contacts(std::vector<Contact>& contacts, RigidStates& rigid);

  double dt_ = 0;
  std::vector<TouchedPoints> touched_;
  std::vector<Row> rows_;
  HandleSolver handle_solver_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI

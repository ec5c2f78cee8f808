#pragma once

#include <span>

#include "contact.h"
#include "softpoint/core/deformable_system.h"
#include "support_contacts.h"

namespace softpoint::inline SOFTPOINT_ABI {

// A point of a deformable held at a target (DeformableSystem::grab).
struct Handle {
  HandleId id = 0;
  int body = 0;
  int point = 0;
  Vec3 target = Vec3::Zero();   // m
  double max_force = 0;         // N
  Vec3 impulse = Vec3::Zero();  // N s on the body over the substep
  bool unreached = false;       // the point was not brought to the target although force is left
};

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
  // Touched points of one body and their compliance.
  struct Touched {
    std::vector<int> points;         // vertex indices, ascending
    std::vector<int> local;          // vertex -> index in `points`, -1 elsewhere
    std::vector<double> blocks;      // 3n x 3n column-major, velocity per impulse
    std::vector<Vec3> displacement;  // of each touched point by impulses, m
    std::vector<Vec3> reference;     // the same at the last detection
    std::vector<Vec3> impulses;      // sum per touched point, N s
  };
  // A contact ready for sweeping.
  struct Row {
    std::array<int, 3> local{};
    Mat3 compliance;  // m per N s at the contact
    Vec3 tangent_a, tangent_b;
    double tangent_gain = 0;  // 1 / largest eigenvalue of the tangent block
    double normal_gain = 0;   // 1 / (n . A n)
    Eigen::Matrix<double, 2, 2, Eigen::DontAlign> tangent_inverse;
    double gap_base = 0;            // gap without any motion counted from the free end
    Vec3 slip_base = Vec3::Zero();  // free motion of the contact point over the step
  };
  struct HandleRow {
    int local = 0;
    Mat3 inverse;
    Vec3 base = Vec3::Zero();  // free end minus target
  };

  void collect_touched(std::span<Deformable* const> bodies, const std::vector<Contact>& contacts,
                       const std::vector<Handle>& handles, Profile& profile);
  void prepare_rows(std::span<Deformable* const> bodies, std::vector<Contact>& contacts,
                    std::vector<Handle>& handles, RigidStates& rigid);
  Vec3 moved(const Contact& contact, const Row& row, const std::vector<Vec3> Touched::*field) const;
  void add_impulse(const Contact& contact, const Row& row, const Vec3& impulse, RigidStates& rigid);
  void spread(Touched& touched, int local, const Vec3& impulse);
  void move_all(std::span<Deformable* const> bodies, RigidStates& rigid);
  double sweep_contacts(std::vector<Contact>& contacts, RigidStates& rigid);
  double sweep_handles(std::vector<Handle>& handles);

  double dt_ = 0;
  std::vector<Touched> touched_;
  std::vector<Row> rows_;
  std::vector<HandleRow> handle_rows_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI

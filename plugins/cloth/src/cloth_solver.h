#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "air_pocket.h"
#include "softpoint/cloth/cloth_settings.h"
#include "softpoint/cloth/pattern.h"
#include "solver_profile.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// A surface that a point may touch: it stays on the side of `normal` of the plane through `foot`. What the
// caller wants kept free (half the thickness) is in `foot`. World frame.
struct ContactPlane {
  Vec3 normal = Vec3::UnitZ();
  Vec3 foot = Vec3::Zero();      // m, at the start of the frame or, set later, of the next small step
  Vec3 velocity = Vec3::Zero();  // m/s, of the surface there; the plane moves with it
  double friction = 0;           // Coulomb's coefficient
  double adhesion = 0;           // N, presses the point on while it touches: friction acts on the sum
  int collider = -1;  // the caller's; forces are summed by point, so the solver does not look at it
};

// The planes of one point, nearest first.
struct PointContacts {
  int count = 0;  // 0 to 2
  ContactPlane planes[2];
};

// Holds a point, exactly or with a limited force.
struct ClothHand {
  int point = -1;
  Vec3 target = Vec3::Zero();    // m, at the end of the frame; the way there is a cubic from where it is
  Vec3 velocity = Vec3::Zero();  // m/s, at the end of the frame
  double max_force = std::numeric_limits<double>::infinity();  // N
  // Where the way begins; otherwise where the hand was at the end of the last frame.
  bool starts = false;
  Vec3 start = Vec3::Zero();           // m
  Vec3 start_velocity = Vec3::Zero();  // m/s
  // Of a hand that gives way, kg, 0: none does: within a small step it goes on from `start`, where it is when
  // it is set, with `velocity`, and pulls with what changes the velocity of such a mass to that of the point.
  double mass = 0;
};

// What a pocket is at the end of a small step.
struct PocketState {
  double volume = 0;  // m3
  double gauge = 0;   // Pa, its pressure less the ambient one
};

class ClothStepper;

// Moves a cloth: small implicit steps solved in the positions (doc/solver.md). Knows no Bullet. Positions,
// feet of planes and hands are in the world; rim quads and closures of pockets are in coordinates whose
// origin is `air_origin`. A frame is begin_frame, as many substeps as it says, end_frame; contacts, air and
// hands may be set anew between substeps. Nothing is allocated after the first frame with as many hands and
// pockets.
class ClothSolver {
 public:
  // At rest in the pattern's shape. Throws Error for what is out of range.
  ClothSolver(const ClothPattern& pattern, const Fabric& fabric, const ClothSettings& settings = {});
  ~ClothSolver();
  ClothSolver(ClothSolver&&) noexcept;
  ClothSolver& operator=(ClothSolver&&) noexcept;

  int point_count() const;
  const ClothPattern& pattern() const;
  const ClothSettings& settings() const;
  // Precision too may change. Throws Error for what is out of range.
  void set_settings(const ClothSettings& settings);

  // One entry a point. Neither wakes nor warns: the caller's numbers must be finite.
  void set_positions(std::span<const Vec3> positions);    // m
  void set_velocities(std::span<const Vec3> velocities);  // m/s
  void set_masses(std::span<const double> masses);        // kg
  // Factors on the springs' stiffness, one a spring (wet cloth); empty: 1.
  void set_stiffness_factors(std::span<const double> factors);
  void set_gravity(const Vec3& gravity);                       // m/s2
  void set_wind(const Vec3& velocity);                         // m/s, what drag is relative to
  void set_forces(std::span<const Vec3> forces);               // N, beyond all else; empty: none
  void set_contacts(std::span<const PointContacts> contacts);  // empty: none
  void set_hands(std::span<const ClothHand> hands);
  // The pocket of each face (-1: none), the pockets and what closes them. Empty faces: no air.
  // Whether something else corrects positions after each small step: frames from the next one on have as many
  // as the sweeps would take.
  void set_meets_itself(bool on);
  void set_air(std::span<const int> face_pocket, std::span<const AirPocket> pockets,
               std::span<const RimQuad> rims, const Vec3& air_origin = Vec3::Zero());

  // Fair checks of the energy guard in a row: with positions and velocities set before each frame, all that
  // the next frame depends on besides. For snapshots.
  int& guard_calm();
  // For snapshots, of the end of the last small step, from which the next one goes on: pressures of the
  // pockets (Pa); whether a point was off (0), stuck (1) or slid (2).
  std::vector<double>& first_gauges();
  int touch_state(int point) const;
  void set_touch_state(int point, int state);
  // How many substeps a step of `dt` (s) wants with the hands and contacts as they are.
  int begin_frame(double dt);
  void substep();
  void end_frame();
  // All of a frame: what is set stays as it is.
  void step(double dt);

  // At the end of the last substep.
  void positions(std::span<Vec3> out) const;
  void velocities(std::span<Vec3> out) const;
  Vec3 position(int point) const;
  Vec3 velocity(int point) const;
  std::span<const PocketState> pockets() const;
  // Force of its contacts on a point in the last substep, N.
  Vec3 contact_force(int point) const;
  // The mean over the substeps of this frame so far: dt times it is what the collider gets, reversed.
  Vec3 mean_contact_force(int point) const;
  bool touching(int point) const;
  // Force a hand exerts on its point against springs (without dampers), weight, air and forces; inertia is
  // not in it. N.
  Vec3 hand_force(int hand) const;
  // What it gave its point in the last substep, inertia and dampers included, N s.
  Vec3 hand_impulse(int hand) const;
  double kinetic_energy() const;     // J
  double potential_energy() const;   // J: springs, bending, weight, air
  double mechanical_energy() const;  // J: kinetic and potential without the air's
  const SolverProfile& profile() const;

 private:
  std::unique_ptr<ClothStepper> stepper_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

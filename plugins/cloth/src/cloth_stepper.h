#pragma once

#include <memory>
#include <span>
#include <vector>

#include "cloth_solver.h"
#include "sweep_layout.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// What a solver was told, in double and in the order of the points.
struct ClothInputs {
  ClothInputs(const ClothPattern& cloth, const Fabric& stuff, const ClothSettings& dial)
      : pattern(cloth), fabric(stuff), settings(dial), layout(cloth) {}

  ClothPattern pattern;
  Fabric fabric;
  ClothSettings settings;
  SweepLayout layout;
  std::vector<double> masses;
  std::vector<double> stiffness_factors;
  Vec3 gravity = Vec3::Zero(), wind = Vec3::Zero();
  std::vector<Vec3> forces;
  std::vector<PointContacts> contacts;
  std::vector<ClothHand> hands;
  std::vector<int> face_pocket;
  std::vector<AirPocket> pockets;
  std::vector<RimQuad> rims;
  Vec3 air_origin = Vec3::Zero();
  bool meets_itself = false;  // what keeps cloth from cloth works after each small step: they are to be short
};

// The work behind ClothSolver, in single or in double.
class ClothStepper {
 public:
  virtual ~ClothStepper() = default;

  virtual void set_positions(std::span<const Vec3> positions) = 0;
  virtual void set_velocities(std::span<const Vec3> velocities) = 0;
  virtual void masses_changed() = 0;
  virtual void forces_changed() = 0;
  virtual void stiffness_changed() = 0;
  virtual void contacts_changed() = 0;
  virtual void hands_changed() = 0;
  virtual void air_changed() = 0;

  // All that a frame begun anew remembers of the ones before, for snapshots: fair checks of the energy in a
  // row, pressures of the pockets (Pa), and whether a point was off (0), stuck (1) or slid (2).
  virtual int& calm() = 0;
  virtual std::vector<double>& gauges() = 0;
  virtual int touch_state(int point) const = 0;
  virtual void set_touch_state(int point, int state) = 0;
  virtual int begin_frame(double dt) = 0;
  virtual void substep() = 0;
  virtual void end_frame() = 0;

  virtual Vec3 position(int point) const = 0;
  virtual Vec3 velocity(int point) const = 0;
  virtual Vec3 contact_force(int point) const = 0;
  virtual Vec3 mean_contact_force(int point) const = 0;
  virtual bool touching(int point) const = 0;
  virtual Vec3 hand_force(int hand) const = 0;
  virtual Vec3 hand_impulse(int hand) const = 0;
  virtual double kinetic_energy() const = 0;
  virtual double potential_energy() const = 0;
  virtual double mechanical_energy() const = 0;
  virtual std::span<const PocketState> pockets() const = 0;

  ClothInputs& inputs() { return *in_; }
  std::shared_ptr<ClothInputs> share_inputs() { return in_; }
  SolverProfile profile;

 protected:
  explicit ClothStepper(std::shared_ptr<ClothInputs> in) : in_(std::move(in)) {}
  std::shared_ptr<ClothInputs> in_;
};

// By the precision of the settings.
std::unique_ptr<ClothStepper> make_stepper(std::shared_ptr<ClothInputs> inputs);

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

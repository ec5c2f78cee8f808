#include "cloth_solver.h"

#include "cloth_stepper.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

ClothSolver::ClothSolver(const ClothPattern& pattern, const Fabric& fabric, const ClothSettings& settings) {
  check(pattern);
  check(fabric);
  check(settings);
  auto inputs = std::make_shared<ClothInputs>(pattern, fabric, settings);
  inputs->masses = pattern.masses;
  stepper_ = make_stepper(std::move(inputs));
}

ClothSolver::~ClothSolver() = default;
ClothSolver::ClothSolver(ClothSolver&&) noexcept = default;
ClothSolver& ClothSolver::operator=(ClothSolver&&) noexcept = default;

int ClothSolver::point_count() const { return pattern().point_count(); }
const ClothPattern& ClothSolver::pattern() const { return stepper_->inputs().pattern; }
const ClothSettings& ClothSolver::settings() const { return stepper_->inputs().settings; }

void ClothSolver::set_settings(const ClothSettings& settings) {
  check(settings);
  const bool same = settings.precision == stepper_->inputs().settings.precision;
  stepper_->inputs().settings = settings;
  if (same) return;
  std::vector<Vec3> x(point_count()), v(point_count());
  positions(x);
  velocities(v);
  const SolverProfile profile = stepper_->profile;
  stepper_ = make_stepper(stepper_->share_inputs());
  stepper_->set_positions(x);
  stepper_->set_velocities(v);
  stepper_->hands_changed();
  stepper_->contacts_changed();
  stepper_->profile = profile;
}

void ClothSolver::set_positions(std::span<const Vec3> positions) { stepper_->set_positions(positions); }
void ClothSolver::set_velocities(std::span<const Vec3> velocities) { stepper_->set_velocities(velocities); }

void ClothSolver::set_masses(std::span<const double> masses) {
  stepper_->inputs().masses.assign(masses.begin(), masses.end());
  stepper_->masses_changed();
}
void ClothSolver::set_stiffness_factors(std::span<const double> factors) {
  stepper_->inputs().stiffness_factors.assign(factors.begin(), factors.end());
  stepper_->stiffness_changed();
}
void ClothSolver::set_gravity(const Vec3& gravity) {
  stepper_->inputs().gravity = gravity;
  stepper_->forces_changed();
}
void ClothSolver::set_wind(const Vec3& velocity) {
  stepper_->inputs().wind = velocity;
  stepper_->forces_changed();
}
void ClothSolver::set_forces(std::span<const Vec3> forces) {
  stepper_->inputs().forces.assign(forces.begin(), forces.end());
  stepper_->forces_changed();
}
void ClothSolver::set_contacts(std::span<const PointContacts> contacts) {
  stepper_->inputs().contacts.assign(contacts.begin(), contacts.end());
  stepper_->contacts_changed();
}
void ClothSolver::set_hands(std::span<const ClothHand> hands) {
  stepper_->inputs().hands.assign(hands.begin(), hands.end());
  stepper_->hands_changed();
}
void ClothSolver::set_air(std::span<const int> face_pocket, std::span<const AirPocket> pockets,
                          std::span<const RimQuad> rims, const Vec3& air_origin) {
  ClothInputs& in = stepper_->inputs();
  in.face_pocket.assign(face_pocket.begin(), face_pocket.end());
  in.pockets.assign(pockets.begin(), pockets.end());
  in.rims.assign(rims.begin(), rims.end());
  in.air_origin = air_origin;
  stepper_->air_changed();
}

void ClothSolver::set_meets_itself(bool on) { stepper_->inputs().meets_itself = on; }

int& ClothSolver::guard_calm() { return stepper_->calm(); }

std::vector<double>& ClothSolver::first_gauges() { return stepper_->gauges(); }

int ClothSolver::touch_state(int point) const { return stepper_->touch_state(point); }

void ClothSolver::set_touch_state(int point, int state) { stepper_->set_touch_state(point, state); }
int ClothSolver::begin_frame(double dt) { return stepper_->begin_frame(dt); }
void ClothSolver::substep() { stepper_->substep(); }
void ClothSolver::end_frame() { stepper_->end_frame(); }
void ClothSolver::step(double dt) {
  const int count = begin_frame(dt);
  for (int i = 0; i < count; ++i) substep();
  end_frame();
}

void ClothSolver::positions(std::span<Vec3> out) const {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = stepper_->position(static_cast<int>(i));
}
void ClothSolver::velocities(std::span<Vec3> out) const {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = stepper_->velocity(static_cast<int>(i));
}
Vec3 ClothSolver::position(int point) const { return stepper_->position(point); }
Vec3 ClothSolver::velocity(int point) const { return stepper_->velocity(point); }
std::span<const PocketState> ClothSolver::pockets() const { return stepper_->pockets(); }
Vec3 ClothSolver::contact_force(int point) const { return stepper_->contact_force(point); }
Vec3 ClothSolver::mean_contact_force(int point) const { return stepper_->mean_contact_force(point); }
bool ClothSolver::touching(int point) const { return stepper_->touching(point); }
Vec3 ClothSolver::hand_force(int hand) const { return stepper_->hand_force(hand); }
Vec3 ClothSolver::hand_impulse(int hand) const { return stepper_->hand_impulse(hand); }
double ClothSolver::kinetic_energy() const { return stepper_->kinetic_energy(); }
double ClothSolver::potential_energy() const { return stepper_->potential_energy(); }
double ClothSolver::mechanical_energy() const { return stepper_->mechanical_energy(); }
const SolverProfile& ClothSolver::profile() const { return stepper_->profile; }

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

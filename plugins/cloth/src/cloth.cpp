// Construction, setters and snapshots. The step: cloth_step.cpp.
#include "softpoint/cloth/cloth.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "cloth_state.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

constexpr double kMaxFriction = 100.0;

void check_saturation(std::span<const double> saturation, std::size_t points) {
  if (saturation.size() != points) {
    throw Error("saturation: " + std::to_string(saturation.size()) +
                " entries; permitted is one per point, " + std::to_string(points));
  }
  for (std::size_t i = 0; i < points; ++i) {
    check_range("saturation of point " + std::to_string(i), saturation[i], 0.0, 1.0);
  }
}

// The longest step of the explicit scheme that its springs, dry and at their stiffest, do not burst at, s: by
// the largest sum of what acts on a point over its mass.
double stable_step(const ClothDesign& design) {
  const ClothPattern& pattern = design.pattern;
  const Wetness& wet = design.wetness;
  const double springs = std::max({1.0, wet.warp_factor, wet.weft_factor, wet.shear_factor});
  const double bends = std::max(1.0, wet.bending_factor);
  std::vector<double> stiff(pattern.points.size(), 0.0);
  for (const Spring& spring : pattern.springs) {
    for (const int v : {spring.a, spring.b})
      stiff[static_cast<std::size_t>(v)] += 2 * springs * spring.stiffness;
  }
  for (const BendElement& bend : pattern.bends) {
    double sum = 0;
    for (const double weight : bend.weight) sum += std::abs(weight);
    for (int k = 0; k < 4; ++k) {
      stiff[static_cast<std::size_t>(bend.point[k])] +=
          bends * bend.stiffness * std::abs(bend.weight[k]) * sum;
    }
  }
  double square = 0;
  for (std::size_t v = 0; v < stiff.size(); ++v) square = std::max(square, stiff[v] / pattern.masses[v]);
  const double frequency = std::sqrt(square), damping = 0.5 * frequency * design.fabric.damping_time;
  const double longest = 2 / (std::max(frequency, 1e-300) * (damping + std::sqrt(1 + damping * damping)));
  return std::min(longest, 1 / std::max(design.fabric.drag_rate, 1e-300));
}

void check_design(const ClothDesign& design) {
  check(design.pattern);
  check(design.fabric);
  check(design.wetness);
  check(design.air);
  check(design.self_contact);
  check(design.solver, "solver");
  if (design.paper && !(design.paper->step <= stable_step(design))) {
    throw Error("paper.step = " + to_text(design.paper->step) + ": permitted is at most " +
                to_text(stable_step(design)) + ", the longest stable step for these springs and masses");
  }
  if (!design.saturation.empty()) {
    check_saturation(design.saturation, design.pattern.points.size());
  }
  if (!design.start.empty() && design.start.size() != design.pattern.points.size()) {
    throw Error("start: " + std::to_string(design.start.size()) + " entries; permitted is one per point, " +
                std::to_string(design.pattern.points.size()) + ", or none");
  }
}

std::vector<Vec3> placed_points(const ClothDesign& design, const Vec3& position, const Mat3& rotation) {
  check_design(design);
  check_range("Cloth: position", position, -kMaxPosition, kMaxPosition);
  check_range(
      "Cloth: rotation, distance from a rotation matrix",
      (rotation.transpose() * rotation - Mat3::Identity()).norm() + std::abs(rotation.determinant() - 1.0),
      0.0, 1e-6);
  std::vector<Vec3> points = design.start.empty() ? design.pattern.points : design.start;
  for (Vec3& p : points) {
    p = rotation * p + position;
  }
  return points;
}

ClothDesign completed(ClothDesign design) {
  if (design.saturation.empty()) {
    design.saturation.assign(design.pattern.points.size(), 0.0);
  }
  return design;
}

}  // namespace

void check(const SelfContact& settings, std::string_view name) {
  check_range(std::string(name) + ".friction", settings.friction, 0.0, kMaxFriction);
}

Cloth::State::State(const ClothDesign& made)
    : design(completed(made)),
      wet(design.pattern),
      solver(design.pattern, design.fabric, design.solver),
      finder(make_air_topology(design.pattern.points, design.pattern.faces), design.air),
      gatherer(design.pattern.points.size()),
      self(design.pattern, design.fabric.thickness),
      coupling(design.pattern) {
  const std::size_t points = design.pattern.points.size();
  for (std::vector<Vec3>* field : {&positions, &velocities, &before, &world_feet, &local_positions,
                                   &local_feet, &foot_forces, &contact_forces}) {
    field->assign(points, Vec3::Zero());
  }
  point_areas = finder.topology().point_areas;
  friction_factor.assign(points, 1.0);
  inverse_masses.assign(points, 0.0);
  air_colliders.assign(points, -1);
  take_saturation();
}

void Cloth::State::take_saturation() {
  wet_pattern(design.pattern, design.saturation, design.wetness, wet);
  solver.set_masses(wet.masses);
  std::vector<double> factors(wet.springs.size(), 1.0);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const double dry = design.pattern.springs[i].stiffness;
    factors[i] = dry > 0.0 ? wet.springs[i].stiffness / dry : 1.0;
  }
  solver.set_stiffness_factors(factors);
  finder.set_saturation(design.saturation);
  for (std::size_t v = 0; v < friction_factor.size(); ++v) {
    friction_factor[v] = cloth::friction_factor(design.wetness, design.saturation[v]);
  }
  if (design.paper) {
    paper = std::make_unique<PaperCloth>(wet, design.fabric, *design.paper);
    paper_on_plane = false;
  }
}

bool Cloth::State::airy() const {
  const AirTopology& topology = finder.topology();
  const auto some = [](const auto& values) {
    return std::any_of(values.begin(), values.end(), [](auto value) { return value > 0; });
  };
  return design.air.bubbles == Bubbles::kOne ||
         (design.air.bubbles == Bubbles::kFound && (some(design.saturation) || some(topology.closed)));
}

Cloth::Cloth(const ClothDesign& design, const Vec3& position, const Mat3& rotation)
    : Deformable(placed_points(design, position, rotation), design.pattern.faces, design.pattern.masses),
      state_(std::make_unique<State>(design)) {
  change_masses(state_->wet.masses);
}

Cloth::~Cloth() = default;

const ClothPattern& Cloth::pattern() const { return state_->design.pattern; }
const Fabric& Cloth::fabric() const { return state_->design.fabric; }
const Wetness& Cloth::wetness() const { return state_->design.wetness; }

void Cloth::set_settings(const ClothSettings& settings) {
  state_->solver.set_settings(settings);
  state_->design.solver = settings;
  wake();
}
const ClothSettings& Cloth::settings() const { return state_->design.solver; }

void Cloth::set_air(const AirSettings& settings) {
  state_->finder.set_settings(settings);
  state_->design.air = settings;
  wake();
}
const AirSettings& Cloth::air() const { return state_->design.air; }

void Cloth::set_saturation(std::span<const double> saturation) {
  check_saturation(saturation, positions_.size());
  state_->design.saturation.assign(saturation.begin(), saturation.end());
  state_->take_saturation();
  change_masses(state_->wet.masses);
  wake();
}
std::span<const double> Cloth::saturation() const { return state_->design.saturation; }

void Cloth::set_self_contact(const SelfContact& settings) {
  check(settings);
  state_->design.self_contact = settings;
  wake();
}
const SelfContact& Cloth::self_contact() const { return state_->design.self_contact; }

void Cloth::set_wind(const Vec3& velocity) {
  check_range("set_wind: velocity", velocity, -kMaxSpeed, kMaxSpeed);
  state_->wind = velocity;
  wake();
}
const Vec3& Cloth::wind() const { return state_->wind; }

void Cloth::set_velocity(const Vec3& linear, const Vec3& angular) {
  check_range("set_velocity: linear", linear, -kMaxSpeed, kMaxSpeed);
  check_range("set_velocity: angular", angular, -kMaxSpin, kMaxSpin);
  const Vec3 center = center_of_mass();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    velocities_[v] = linear + angular.cross(positions_[v] - center);
  }
  wake();
}

const ClothProfile& Cloth::profile() const { return state_->profile; }

void Cloth::commit(double) {
  positions_ = end_positions_;
  velocities_ = state_->velocities;
}

void Cloth::restored() {
  state_->self.forget();
  state_->bubbles.clear();
  state_->last_targets.clear();
}

// Settings are the application's: they have to be the same. What is wet decides masses, so it has to be, too.
void Cloth::archive_state(StateArchive& archive) {
  State& s = *state_;
  archive.constant("hash of the springs",
                   state_hash(s.wet.springs.data(), 0) ^ static_cast<std::uint64_t>(s.wet.springs.size()));
  archive.number("solver.max_substep", s.design.solver.max_substep, kMinSubstep, 1.0);
  archive.vector("wind", s.wind);
  archive.integer("solver.calm", s.solver.guard_calm(), 0, 2147483647);
  archive.list("solver.gauges", s.solver.first_gauges(), static_cast<long long>(s.wet.faces.size()),
               [&](double& gauge) { archive.number("solver.gauge", gauge); });
  for (int p = 0; p < static_cast<int>(positions_.size()); ++p) {
    int state = s.solver.touch_state(p);
    archive.integer("solver.touch", state, 0, 2);
    if (archive.loading()) s.solver.set_touch_state(p, state);
  }
  s.finder.archive(archive);
  s.self.archive(archive, static_cast<int>(positions_.size()));
  archive.list("targets", s.last_targets, static_cast<long long>(1) << 40, [&](State::LastTarget& last) {
    archive.integer("target.handle", last.handle, 1, (static_cast<long long>(1) << 62));
    archive.vector("target", last.target);
    archive.vector("target.velocity", last.velocity);
  });
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

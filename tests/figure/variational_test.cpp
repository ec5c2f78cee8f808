// The variational integrator by the laws it is made for: momentum, reversal, energy that does not drift.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <memory>
#include <string>

#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_stepper.h"
#include "support.h"

namespace softpoint::figure {
namespace {

FigureModel humanoid_with_armature(double armature) {
  std::vector<Link> links = read_amdl_file(data_file("mjhum27.amdl")).links();
  for (Link& link : links) link.armature = armature;
  return FigureModel(links);
}

FigureState spinning(const FigureModel& model) {
  const auto row = read_rows("out_own_r3_humanoid_spin.csv")[0];
  FigureState state = rest_state(model);
  std::copy_n(&row[14], 21, &state.q[7]);
  std::copy_n(&row[8], 6, &state.qd[0]);
  std::copy_n(&row[35], 21, &state.qd[6]);
  return state;
}

FigureMechanics mechanics_of(FigureStepper& stepper) {
  stepper.dynamics().place(stepper.state().q.data(), stepper.state().qd.data());
  return stepper.dynamics().mechanics();
}

TEST(Variational, MomentumIsKeptInFreeFlightAndEnergyDoesNotDrift) {
  const FigureModel model = humanoid_with_armature(0.01);
  for (const int rate : {60, 240}) {
    FigureStepper stepper(model, spinning(model), Integrator::kVariational);
    const FigureMechanics start = mechanics_of(stepper);
    const auto spin_of = [](const FigureMechanics& m) {  // about the centre of mass
      return Vec3(m.angular_momentum - m.center_of_mass.cross(m.momentum));
    };
    const double seconds = 20, energy = stepper.energy();
    double linear = 0, angular = 0, drift = 0;
    for (int i = 1; i <= seconds * rate; ++i) {
      ASSERT_TRUE(stepper.step(1.0 / rate));
      const FigureMechanics now = mechanics_of(stepper);
      const Vec3 falling =
          model.total_mass() * stepper.dynamics().gravity() * (i / static_cast<double>(rate));
      linear = std::max(linear, (now.momentum - start.momentum - falling).norm());
      angular = std::max(angular, (spin_of(now) - spin_of(start)).norm());
      drift = std::max(drift, std::abs(now.kinetic_energy + now.potential_energy - energy));
    }
    std::printf("    1/%d s: momentum %.1e kg m/s, angular %.1e kg m2/s, energy %.1e J of %.0f\n", rate,
                linear, angular, drift, start.kinetic_energy);
    EXPECT_LE(linear, 1e-9);
    EXPECT_LE(angular, 1e-9);
    EXPECT_LE(drift, 0.5);  // 0.06 to 0.25 at 1/60 s, by roundings
  }
}

// Skeletons of capture files: a root next to nothing between limbs of tonnes. Roundings are then all that a
// search can reach, and shorter steps have more of them.
TEST(Variational, ALightLinkBetweenHeavyOnesIsNoReasonToStop) {
  for (const double root_mass : {1e-6, 1e-3, 1.0}) {
    std::vector<Link> links(4);
    links[0].name = "root";
    links[0].joint = JointKind::kFree;
    links[0].mass = root_mass;
    links[0].inertia = 1e-4 * root_mass * Mat3::Identity();
    for (int i = 1; i < 4; ++i) {
      Link& limb = links[static_cast<std::size_t>(i)];
      limb.name = "limb" + std::to_string(i);
      limb.parent = 0;
      limb.joint = JointKind::kBall;
      set_cylinder(limb, 5000, 0.5, 8);
      limb.orientation = Eigen::AngleAxisd(i, Vec3(1, 0.3 * i, 0.2).normalized()).toRotationMatrix();
    }
    const FigureModel model(links);
    for (const double dt : {1.0 / 15, 1.0 / 240, 1.0 / 1000}) {
      FigureStepper stepper(model, rest_state(model), Integrator::kVariational);
      const double energy = stepper.energy();
      for (int i = 0; i < 60; ++i) ASSERT_TRUE(stepper.step(dt)) << root_mass << " kg, " << dt << " s";
      EXPECT_EQ(stepper.guard_fired(), 0);
      EXPECT_LE(std::abs(stepper.energy() - energy), 1e-5 * model.total_mass() * 9.81)
          << root_mass << " kg, " << dt << " s, " << stepper.unsolved() << " unsolved";
    }
  }
}

// Its steps are their own reversal.
TEST(Variational, RunsBackwards) {
  RandomFigures random(11);
  double worst = 0;
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Link> links = random.model(8, trial % 2 == 0).links();
    for (Link& link : links) link.damping = 0;
    const FigureModel model(links);
    const FigureState start = random.state(model);
    FigureStepper stepper(model, start, Integrator::kVariational);
    for (int i = 0; i < 20; ++i) stepper.step(1.0 / 500);
    FigureState back = stepper.state();
    for (double& v : back.qd) v = -v;
    stepper.set_state(back);
    for (int i = 0; i < 20; ++i) stepper.step(1.0 / 500);
    for (std::size_t k = 0; k < start.q.size(); ++k) {
      worst = std::max(worst, std::abs(std::abs(stepper.state().q[k]) - std::abs(start.q[k])));
    }
  }
  std::printf("    back to within %.1e\n", worst);
  EXPECT_LE(worst, 1e-9);
}

// Some joints swing as they are told.
class Swing : public PrescribedMotion {
 public:
  Swing(const FigureModel& model, std::vector<int> links) : model_(model), links_(std::move(links)) {}
  void evaluate(double time, double* q, double* qd, double* qdd) const override {
    for (const int i : links_) {
      const double rate = 3 + 0.2 * i;
      q[model_.position_offset(i)] = 0.5 * std::sin(rate * time);
      qd[model_.velocity_offset(i)] = 0.5 * rate * std::cos(rate * time);
      qdd[model_.velocity_offset(i)] = -0.5 * rate * rate * std::sin(rate * time);
    }
  }

 private:
  const FigureModel& model_;
  std::vector<int> links_;
};

// All kinds of joints, armatures, friction; a part of them prescribed.
TEST(Variational, HasOrderTwoOnAllKindsOfJoints) {
  RandomFigures random(21);
  for (int trial = 0; trial < 6; ++trial) {
    const FigureModel model = random.model(9, trial % 2 == 0);
    FigureState start = random.state(model);
    std::vector<int> led;
    const auto flags = std::make_unique<bool[]>(9);
    for (int i = 0; i < 9; ++i) {
      const JointKind kind = model.links()[static_cast<std::size_t>(i)].joint;
      flags[static_cast<std::size_t>(i)] = true;
      if ((kind == JointKind::kHinge || kind == JointKind::kPrismatic) && random.below(3) == 0) {
        led.push_back(i);
        flags[static_cast<std::size_t>(i)] = false;
      }
    }
    const Swing swing(model, led);
    std::vector<double> unused(start.qd.size());
    swing.evaluate(0, start.q.data(), start.qd.data(), unused.data());
    const auto after = [&](Integrator integrator, int steps) {
      FigureStepper stepper(model, start, integrator);
      stepper.set_dynamic({flags.get(), 9});
      stepper.set_prescribed_motion(&swing);
      for (int i = 0; i < steps; ++i) stepper.step(0.1 / steps);
      EXPECT_EQ(stepper.guard_fired(), 0);
      return stepper.state();
    };
    const FigureState exact = after(Integrator::kDormandPrince, 2000);
    const auto error = [&](int steps) {
      const FigureState state = after(Integrator::kVariational, steps);
      double worst = 0;
      for (std::size_t k = 0; k < state.qd.size(); ++k)
        worst = std::max(worst, std::abs(state.qd[k] - exact.qd[k]));
      return worst;
    };
    const double coarse = error(200), fine = error(400);
    std::printf("    %zu of 9 prescribed: %.1e to %.1e, order %.2f\n", led.size(), coarse, fine,
                std::log2(coarse / fine));
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.15);
  }
}

// Viscous friction is implicit: no step is too long for it.
TEST(Variational, StrongFrictionStopsJoints) {
  std::vector<Link> links = read_amdl_file(data_file("pend2.amdl")).links();
  for (Link& link : links) link.damping = 1e5;
  const FigureModel model(links);
  FigureStepper stepper(model, {{0.5, -0.3}, {3, -2}}, Integrator::kVariational);
  double energy = stepper.energy();
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(stepper.step(1.0 / 60));
    EXPECT_LE(stepper.energy(), energy + 1e-9);
    energy = stepper.energy();
  }
  EXPECT_NEAR(stepper.state().q[0], 0.5, 0.06);
}

}  // namespace
}  // namespace softpoint::figure

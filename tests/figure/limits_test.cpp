// Joints within their ranges: the exact stops against a trajectory with known events and by their laws, the
// paper's steps with their faults counted.
#include <gtest/gtest.h>

#include <numbers>

#include "many_starts.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_stepper.h"
#include "support.h"
#include "support/refusal.h"
#include "support/tier.h"

namespace softpoint::figure {
namespace {

struct Comparison {
  double joints = 0, events = 0;
  std::size_t met = 0;
};

Comparison compare(Integrator integrator, int steps) {
  const auto rows = read_rows("out_own_r6_double_pendulum_limit.csv");
  std::vector<double> times;
  std::vector<int> sides, impacts;
  {
    std::ifstream file(data_file("out_own_r6_double_pendulum_limit_events.csv"));
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
      std::stringstream cells(line);
      std::string cell;
      std::getline(cells, cell, ',');
      times.push_back(std::stod(cell));
      std::getline(cells, cell, ',');
      std::getline(cells, cell, ',');
      sides.push_back(std::stoi(cell));
      std::getline(cells, cell, ',');
      impacts.push_back(cell.rfind("impact", 0) == 0);
    }
  }
  FigureStepper stepper(read_amdl_file(data_file("pend2_limits.amdl")),
                        {{-std::numbers::pi / 2, -0.5}, {0, 0}}, integrator);
  stepper.set_limits(LimitMode::kExact);
  Comparison result;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double dt = (rows[i][0] - rows[i - 1][0]) / steps;
    for (int k = 0; k < steps; ++k) {
      EXPECT_TRUE(stepper.step(dt));
      for (const LimitEvent& event : stepper.events()) {
        if (result.met < times.size()) {
          result.events = std::max(result.events, std::abs(event.time - times[result.met]));
          EXPECT_EQ(event.link, 1);
          EXPECT_EQ(event.side, sides[result.met]);
          EXPECT_EQ(event.impact, impacts[result.met] == 1);
        }
        ++result.met;
      }
      EXPECT_GE(stepper.state().q[1], -0.9);
      EXPECT_LE(stepper.state().q[1], 0.4);
    }
    for (std::size_t j = 0; j < 2; ++j) {
      result.joints = std::max(result.joints, std::abs(stepper.state().q[j] - rows[i][1 + j]));
    }
  }
  EXPECT_EQ(result.met, times.size());
  EXPECT_EQ(stepper.limit_counts().capped + stepper.limit_counts().unfinished, 0);
  return result;
}

TEST(Limits, DoublePendulumMeetsItsStopsWhenItShould) {
  const Comparison fine = compare(Integrator::kDormandPrince, 16);
  std::printf("    r6: joints %.1e rad, times of events %.1e s\n", fine.joints, fine.events);
  EXPECT_LE(fine.joints, 1e-8);
  EXPECT_LE(fine.events, 1e-8);
}

TEST(Limits, RungeKuttaKeepsOrderFourThroughStops) {
  const Comparison coarse = compare(Integrator::kRungeKutta4, 2), fine = compare(Integrator::kRungeKutta4, 4);
  const double observed = std::log2(coarse.joints / fine.joints);
  std::printf("    %.2e to %.2e, order %.2f\n", coarse.joints, fine.joints, observed);
  EXPECT_NEAR(observed, 4, 0.3);
}

TEST(Limits, VariationalStepsKeepOrderTwoThroughStops) {
  const Comparison coarse = compare(Integrator::kVariational, 8),
                   fine = compare(Integrator::kVariational, 16);
  const double observed = std::log2(coarse.joints / fine.joints);
  std::printf("    %.2e to %.2e, order %.2f\n", coarse.joints, fine.joints, observed);
  EXPECT_NEAR(observed, 2, 0.2);
}

FigureState random_start(const FigureModel& model, RandomFigures& random, double speed) {
  FigureState state = rest_state(model);
  for (int i = 1; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    const double share = 0.5 + 0.5 * std::tanh(random.vector().x());
    state.q[static_cast<std::size_t>(model.position_offset(i))] =
        link.lower + share * (link.upper - link.lower);
  }
  for (double& v : state.qd) v = speed * random.vector().x();
  return state;
}

TEST(Limits, ManyJointsAtOnceStayInsideAndEverySearchEnds) {
  const FigureModel model = read_amdl_file(data_file("mjhum27.amdl"));
  expect_many_starts_stay_inside(by_tier(1000, 12, 2), 1, 10, [&](RandomFigures& random, int) {
    return FigureStepper(model, random_start(model, random, 2.0));
  });
}

// Of a thousand starts, steps of 1/30 s: some joints at rest on a stop have hardly any acceleration, and
// would leave it and meet it without end.
TEST(Limits, NoStepOfAThousandStartsHasTooManyEvents) {
  const FigureModel model = read_amdl_file(data_file("mjhum27.amdl"));
  RandomFigures random(1);
  long long capped = 0, unfinished = 0;
  const int first = by_tier(0, 650, 985);
  for (int trial = 0; trial < 1000; ++trial) {
    FigureState start = random_start(model, random, 2.0);
    if (trial < first) continue;
    FigureStepper stepper(model, std::move(start));
    stepper.set_limits(LimitMode::kExact);
    for (int i = 0; i < 15; ++i) stepper.step(1.0 / 30);
    capped += stepper.limit_counts().capped;
    unfinished += stepper.limit_counts().unfinished;
  }
  EXPECT_EQ(capped, 0);
  EXPECT_EQ(unfinished, 0);
}

// A stop takes energy or leaves it.
TEST(Limits, ABlowNeverRaisesTheKineticEnergy) {
  const FigureModel model = read_amdl_file(data_file("mjhum27.amdl"));
  RandomFigures random(9);
  double gain = -1e300;
  int blows = 0;
  for (int trial = 0; trial < 300; ++trial) {
    FigureState state = random_start(model, random, 3.0);
    for (int i = 1; i < model.link_count(); ++i) {
      const Link& link = model.links()[static_cast<std::size_t>(i)];
      if (random.below(3) == 0) state.q[static_cast<std::size_t>(model.position_offset(i))] = link.upper;
      if (random.below(5) == 0) state.q[static_cast<std::size_t>(model.position_offset(i))] = link.lower;
    }
    FigureStepper stepper(model, state);
    stepper.dynamics().set_gravity(Vec3::Zero());
    stepper.set_limits(LimitMode::kExact);
    const double before = stepper.energy();
    stepper.step(1e-9);
    gain = std::max(gain, (stepper.energy() - before) / before);
    blows += static_cast<int>(stepper.limit_counts().impacts);
    EXPECT_EQ(stepper.limit_counts().unfinished, 0);
  }
  std::printf("    %d blows, largest change of the energy %.1e of it\n", blows, gain);
  EXPECT_GT(blows, 300);
  EXPECT_LE(gain, 1e-6);  // of the step of 1 ns itself
}

// Its known faults, in figures: joints held by a torque that pulls, and steps with stops that raise the
// energy, the work of gravity being in it.
TEST(Limits, ThePapersStepsEndAndTheirFaultsAreCounted) {
  const FigureModel model = read_amdl_file(data_file("mjhum27.amdl"));
  const int starts = by_tier(1000, 40, 5);
  for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
    RandomFigures random(1);
    LimitCounts sum;
    double violation = 0, most = 0;
    long long steps = 0, stopped = 0, rises = 0, guard = 0;
    for (int trial = 0; trial < starts; ++trial) {
      FigureStepper stepper(model, random_start(model, random, 2.0), Integrator::kPaper);
      stepper.set_limits(LimitMode::kPaper);
      for (int link = 1; link < model.link_count(); ++link) stepper.set_paper_friction(link, 0.8);
      double before = stepper.energy();
      for (int i = 0; i * dt < 0.5; ++i) {
        const long long passes = stepper.limit_counts().passes;
        stepper.step(dt);
        ++steps;
        violation = std::max(violation, outside_ranges(model, stepper.state()));
        const double after = stepper.energy();
        if (stepper.limit_counts().passes - passes > 1) {
          ++stopped;
          rises += after > before + 1e-9;
          most = std::max(most, after - before);
        }
        before = after;
      }
      sum.passes += stepper.limit_counts().passes;
      sum.wrong_sign += stepper.limit_counts().wrong_sign;
      sum.unfinished += stepper.limit_counts().unfinished;
      guard += stepper.guard_fired();
    }
    std::printf(
        "    paper, dt %.4f: %lld steps, %lld with stops, %lld passes; outside by %.1e; %lld joints held by "
        "a "
        "pull; energy risen in %lld, by %.3g J at most; %lld unfinished, guard %lld\n",
        dt, steps, stopped, sum.passes, violation, sum.wrong_sign, rises, most, sum.unfinished, guard);
    EXPECT_LE(violation, 1e-10);
    EXPECT_EQ(sum.unfinished, 0);
    EXPECT_EQ(guard, 0);
    EXPECT_GT(sum.wrong_sign, 0);
    EXPECT_GT(rises, 0);
  }
}

TEST(Limits, WhatDoesNotGoTogetherIsRefused) {
  const FigureModel model = read_amdl_file(data_file("pend2_limits.amdl"));
  FigureStepper exact(model, rest_state(model)), paper(model, rest_state(model), Integrator::kPaper);
  expect_refusal([&] { exact.set_limits(LimitMode::kPaper); }, {"limits = paper", "rk4", "permitted"});
  expect_refusal([&] { paper.set_limits(LimitMode::kExact); }, {"limits = exact", "paper", "permitted"});
  expect_refusal([&] { paper.set_paper_friction(0, 1.5); }, {"paper friction factor = 1.5", "0 to 1"});
  expect_refusal([&] { paper.set_paper_friction(7, 0.5); }, {"link = 7"});
  exact.set_limits(LimitMode::kExact);
  FigureState bent = rest_state(model);
  bent.q[1] = 0.5;
  expect_refusal([&] { exact.set_state(bent); }, {"link 1 'p1' q", "0.5", "-0.9 to 0.4"});
  EXPECT_EQ(exact.state().q[1], 0);
}

}  // namespace
}  // namespace softpoint::figure

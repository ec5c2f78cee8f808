// Figures in the lanes of vectors have the accelerations that each has alone, for every instruction set.
#include "softpoint/figure/figure_crowd.h"

#include <gtest/gtest.h>

#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_dynamics.h"
#include "support.h"
#include "support/refusal.h"

namespace softpoint::figure {
namespace {

TEST(FigureCrowd, EachFigureHasItsOwnAccelerations) {
  RandomFigures random(31);
  double worst = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const FigureModel model = random.model(3 + trial, trial % 2 == 0);
    const int figures = 1 + trial;  // mostly no whole number of vectors
    for (const InstructionSet set :
         {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      FigureCrowd crowd(model, figures, set);
      FigureDynamics alone(model);
      const Vec3 gravity = random.vector();
      crowd.set_gravity(gravity);
      alone.set_gravity(gravity);
      std::vector<FigureState> states;
      std::vector<std::vector<double>> torques;
      for (int i = 0; i < figures; ++i) {
        states.push_back(random.state(model));
        torques.push_back(random.numbers(model.velocity_count()));
        crowd.set_state(i, states.back().q, states.back().qd);
        crowd.set_torque(i, torques.back());
      }
      crowd.forward();
      crowd.forward();  // uses nothing up
      std::vector<double> expected(states[0].qd.size()), got(expected);
      for (int i = 0; i < figures; ++i) {
        const auto k = static_cast<std::size_t>(i);
        alone.forward(states[k].q.data(), states[k].qd.data(), torques[k].data(), expected.data());
        crowd.acceleration(i, got);
        double size = 0, difference = 0;
        for (std::size_t n = 0; n < got.size(); ++n) {
          size = std::max(size, std::abs(expected[n]));
          difference = std::max(difference, std::abs(expected[n] - got[n]));
        }
        worst = std::max(worst, difference / size);
      }
    }
  }
  std::printf("    %s, off by %.1e\n", name(best_instruction_set()), worst);
  EXPECT_LE(worst, 1e-11);
}

TEST(FigureCrowd, RefusesWhatDoesNotFit) {
  const FigureModel model = read_amdl_file(data_file("pend2.amdl"));
  expect_refusal([&] { FigureCrowd(model, 0); }, {"figures = 0", "permitted"});
  FigureCrowd crowd(model, 3);
  std::vector<double> two(2), three(3);
  expect_refusal([&] { crowd.set_state(3, two, two); }, {"figure = 3"});
  expect_refusal([&] { crowd.set_state(0, three, two); }, {"q has 3 numbers", "permitted are 2"});
  expect_refusal([&] { crowd.set_torque(0, three); }, {"tau has 3 numbers"});
  expect_refusal([&] { crowd.acceleration(-1, two); }, {"figure = -1"});
}

}  // namespace
}  // namespace softpoint::figure

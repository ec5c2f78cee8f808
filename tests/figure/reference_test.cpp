// Trajectories on which several engines agree, and the order in which each integrator comes to them.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>

#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_stepper.h"
#include "support.h"

namespace softpoint::figure {
namespace {

// Largest difference of the compared numbers over all rows up to `until` s, with so many steps a row.
template <class Compare>
double worst_over(FigureStepper stepper, const std::vector<std::vector<double>>& rows, int steps,
                  double until, Compare compare) {
  double worst = 0;
  for (std::size_t i = 1; i < rows.size() && rows[i][0] <= until; ++i) {
    const double dt = (rows[i][0] - rows[i - 1][0]) / steps;
    for (int k = 0; k < steps; ++k) stepper.step(dt);
    worst = std::max(worst, compare(stepper, rows[i]));
  }
  EXPECT_EQ(stepper.guard_fired(), 0);
  return worst;
}

double largest_difference(const double* a, const double* b, int count) {
  double worst = 0;
  for (int i = 0; i < count; ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

FigureStepper double_pendulum(Integrator integrator) {
  return {read_amdl_file(data_file("pend2.amdl")), {{-std::numbers::pi / 2, -0.5}, {0, 0}}, integrator};
}
double joints(const FigureStepper& s, const std::vector<double>& row) {
  return largest_difference(s.state().q.data(), row.data() + 1, 2);
}

FigureStepper humanoid(Integrator integrator, const std::vector<double>& row) {
  const FigureModel model = read_amdl_file(data_file("mjhum27.amdl"));
  return {model, humanoid_state(model, row), integrator};
}
double pose(const FigureStepper& s, const std::vector<double>& row) {
  const double* q = s.state().q.data();
  return std::max({largest_difference(q, &row[5], 3), largest_difference(q + 3, &row[1], 4),
                   largest_difference(q + 7, &row[14], 21)});
}

TEST(FigureReference, DoublePendulum) {
  const auto rows = read_rows("out_own_r1_double_pendulum.csv");
  const double worst = worst_over(double_pendulum(Integrator::kDormandPrince), rows, 32, 5.1, joints);
  std::printf("    r1 %.1e\n", worst);
  EXPECT_LE(worst, 1e-8);
}

TEST(FigureReference, ChainOfBalls) {
  const auto rows = read_rows("out_simbody_r2_ball_chain.csv");
  const FigureModel model = read_amdl_file(data_file("chain4ball.amdl"));
  FigureState state = rest_state(model);
  // Orientations and spins of the first row, made relative.
  Eigen::Quaterniond parent = Eigen::Quaterniond::Identity();
  Vec3 parent_spin = Vec3::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    const double* row = &rows[0][1 + 10 * i];
    const Eigen::Quaterniond turn(row[3], row[4], row[5], row[6]);
    const Vec3 spin(row[7], row[8], row[9]);
    const Eigen::Quaterniond own = parent.conjugate() * turn;
    const Vec3 rate = turn.conjugate() * Vec3(spin - parent_spin);
    const double q[] = {own.w(), own.x(), own.y(), own.z()};
    std::copy_n(q, 4, &state.q[4 * i]);
    std::copy_n(rate.data(), 3, &state.qd[3 * i]);
    parent = turn;
    parent_spin = spin;
  }
  const auto centers = [](FigureStepper& s, const std::vector<double>& row) {
    double worst = 0;
    s.dynamics().place(s.state().q.data(), s.state().qd.data());
    for (int i = 0; i < 4; ++i) {
      const LinkMotion motion = s.dynamics().motion(i);
      const Vec3 center = motion.position + motion.orientation * Vec3(0, 0, -0.2);
      worst =
          std::max(worst, largest_difference(center.data(), &row[static_cast<std::size_t>(1 + 10 * i)], 3));
    }
    return worst;
  };
  const double worst =
      worst_over(FigureStepper(model, state, Integrator::kDormandPrince), rows, 8, 2.1, centers);
  std::printf("    r2 %.1e\n", worst);
  EXPECT_LE(worst, 1e-9);
}

TEST(FigureReference, HumanoidInFreeFlight) {
  const auto rows = read_rows("out_own_r3_humanoid_spin.csv");
  const double whole = worst_over(humanoid(Integrator::kDormandPrince, rows[0]), rows, 16, 1.1, pose);
  const double half = worst_over(humanoid(Integrator::kDormandPrince, rows[0]), rows, 16, 0.5001, pose);
  std::printf("    r3 %.1e, first half %.1e\n", whole, half);
  EXPECT_LE(whole, 1e-8);
  EXPECT_LE(half, 1e-10);
}

TEST(FigureReference, IntegratorsHaveTheirOrders) {
  const auto rows = read_rows("out_own_r3_humanoid_spin.csv");
  struct Integration {
    Integrator integrator;
    int steps;
    double slack;
  };
  for (const Integration& c :
       {Integration{Integrator::kPaper, 16, 0.15}, Integration{Integrator::kRungeKutta4, 2, 0.2},
        Integration{Integrator::kDormandPrince, 2, 0.6}, Integration{Integrator::kVariational, 2, 0.1}}) {
    const double coarse = worst_over(humanoid(c.integrator, rows[0]), rows, c.steps, 0.25, pose);
    const double fine = worst_over(humanoid(c.integrator, rows[0]), rows, 2 * c.steps, 0.25, pose);
    const double observed = std::log2(coarse / fine);
    std::printf("    %s: %.2e to %.2e, order %.2f\n", name(c.integrator), coarse, fine, observed);
    EXPECT_NEAR(observed, order(c.integrator), c.slack);
  }
}

}  // namespace
}  // namespace softpoint::figure

// The answers that solvers are measured against, checked against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "benchmarks/whole_bar.h"
#include "support/exact_beam.h"
#include "support/prism_section.h"

namespace softpoint::reference {
namespace {

TEST(PrismSection, TorsionOfTriangleSquareAndCircle) {
  // Equilateral triangle of side a: sqrt(3) a^4 / 80. Square: 0.1405770 a^4 (Timoshenko and Goodier, article
  // 109).
  EXPECT_NEAR(polygon_torsion(3), std::sqrt(3.0) / 80.0 * 9.0, 1e-4);
  EXPECT_NEAR(polygon_torsion(4) / 4.0, 0.1405770, 1e-7);
  EXPECT_NEAR(polygon_torsion(200) / (0.5 * std::numbers::pi), 1.0, 1e-3);
}

TEST(PrismSection, SixteenGonLiesBetweenItsCircles) {
  const double torsion = polygon_torsion(16), inner = std::cos(std::numbers::pi / 16.0);
  EXPECT_GT(torsion, 0.5 * std::numbers::pi * std::pow(inner, 4));
  EXPECT_LT(torsion, 0.5 * std::numbers::pi);
  EXPECT_NEAR(polygon_torsion(16, 2000) / torsion, 1.0, 1e-9);
  const PrismSection section = prism_section(16, 0.5);
  std::printf("16-gon, r = 0.5 m: A = %.9f m^2, I = %.10f m^4, J = %.10f m^4\n", section.area,
              section.second_moment, section.torsion);
  EXPECT_LT(section.torsion, 2.0 * section.second_moment);
  EXPECT_NEAR(section.area, 0.5 * 16 * 0.25 * std::sin(std::numbers::pi / 8), 1e-15);
  // By the corners: I = 1/12 sum (cross product) (x_a^2 + x_a x_b + x_b^2).
  double moment = 0.0;
  for (int k = 0; k < 16; ++k) {
    const double a = std::numbers::pi / 8 * k, b = a + std::numbers::pi / 8;
    const double xa = 0.5 * std::cos(a), xb = 0.5 * std::cos(b);
    moment += 0.25 * std::sin(b - a) * (xa * xa + xa * xb + xb * xb) / 12.0;
  }
  EXPECT_NEAR(section.second_moment, moment, 1e-15);
}

TEST(ExactBeam, TipMomentMakesAnArc) {
  const Beam beam = {13.0, 7e4, 2e4, 4.5e3};
  const double turn = 0.8 * std::numbers::pi;
  const BeamPoint tip = solve_beam(beam, {0.0, 0.0, turn * beam.bending / beam.length}).back();
  const double radius = beam.length / turn;
  EXPECT_NEAR(tip.theta, turn, 1e-10);
  EXPECT_NEAR(tip.x, radius * (1.0 - std::cos(turn)), 1e-9);
  EXPECT_NEAR(tip.z, radius * std::sin(turn), 1e-9);
}

// Bisshopp and Drucker, Q. Appl. Math. 3 (1945): the inextensible cantilever under a dead tip force.
TEST(ExactBeam, WithoutStretchAndShearIsTheElastica) {
  for (double slope : {0.1, 0.5, 1.0, 1.3}) {
    const double k = std::sqrt(0.5 * (1.0 + std::sin(slope))), phi = std::asin(1.0 / (k * std::sqrt(2.0)));
    const double alpha = std::comp_ellint_1(k) - std::ellint_1(k, phi);
    const double across = 1.0 - 2.0 / alpha * (std::comp_ellint_2(k) - std::ellint_2(k, phi));
    const double along = std::sqrt(2.0 * std::sin(slope)) / alpha;
    const Beam beam = {2.0, 1e16, 1e16, 3.0};
    const BeamPoint tip = solve_beam(beam, {alpha * alpha * beam.bending / 4.0, 0.0, 0.0}).back();
    EXPECT_NEAR(tip.theta, slope, 1e-10);
    EXPECT_NEAR(tip.x, 2.0 * across, 2e-10);
    EXPECT_NEAR(tip.z, 2.0 * along, 2e-10);
  }
}

TEST(ExactBeam, SmallLoadsGiveLinearTheory) {
  const Beam beam = prism_beam(16, 0.5, 7.0, 1e5, 0.3);
  const double f = 1e-4, m = 1e-3;
  const BeamPoint pushed = solve_beam(beam, {f, 0.0, 0.0}, 1e-15).back();
  EXPECT_NEAR(pushed.x / (f * (343.0 / (3.0 * beam.bending) + 7.0 / beam.shear)), 1.0, 1e-8);
  EXPECT_NEAR(pushed.theta / (f * 49.0 / (2.0 * beam.bending)), 1.0, 1e-8);
  const BeamPoint pulled = solve_beam(beam, {0.0, f, 0.0}, 1e-15).back();
  EXPECT_NEAR((pulled.z - 7.0) / (f * 7.0 / beam.axial), 1.0, 1e-5);
  const BeamPoint turned = solve_beam(beam, {0.0, 0.0, m}, 1e-15).back();
  EXPECT_NEAR(turned.x / (m * 49.0 / (2.0 * beam.bending)), 1.0, 1e-8);
}

// The work of the load, over its whole path, is the strain energy.
TEST(ExactBeam, EnergyBalances) {
  const Beam beam = prism_beam(16, 0.5, 7.0, 1e5, 0.3);
  const TipLoad full = {40.0, -15.0, 30.0};
  const auto at = [&](double part) {
    return solve_beam(beam, {part * full.force_x, part * full.force_z, part * full.moment});
  };
  double work = 0.0;
  constexpr int kParts = 400;
  BeamPoint last = at(0.0).back();
  for (int i = 1; i <= kParts; ++i) {
    const BeamPoint tip = at(static_cast<double>(i) / kParts).back();
    const double mean = (i - 0.5) / kParts;
    work += mean * (full.force_x * (tip.x - last.x) + full.force_z * (tip.z - last.z) +
                    full.moment * (tip.theta - last.theta));
    last = tip;
  }
  const std::vector<BeamPoint> line = at(1.0);
  double energy = 0.0;
  const double h = beam.length / static_cast<double>(line.size() - 1);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double s = std::sin(line[i].theta), c = std::cos(line[i].theta);
    const double pull = full.force_x * s + full.force_z * c, slide = full.force_x * c - full.force_z * s;
    const double weight = (i == 0 || i + 1 == line.size() ? 0.5 : 1.0) * h;
    energy += 0.5 * weight *
              (pull * pull / beam.axial + slide * slide / beam.shear +
               line[i].moment * line[i].moment / beam.bending);
  }
  EXPECT_NEAR(work / energy, 1.0, 1e-4);
}

TEST(ExactBeam, FindsTheForceForADeflection) {
  const Beam beam = prism_beam(16, 0.5, 13.0, 1e5, 0.3);
  const double force = force_for_deflection(beam, 0.5);
  EXPECT_NEAR(solve_beam(beam, {force, 0.0, 0.0}).back().x, 6.5, 2e-9);
}

TEST(WholeBar, RefinedMeshesApproachTheReference) {
  const BarStiffness reference = whole_bar_stiffness(2);
  double last[3] = {1.0, 1.0, 1.0};
  const double gate[3] = {3e-4, 1.2e-2, 5e-3};
  for (int level : {1, 2}) {
    const BarStiffness k = solve_refined_bar(2, level, 0.3).stiffness;
    const double error[3] = {k.stretch / reference.stretch - 1.0, k.twist / reference.twist - 1.0,
                             k.bend / reference.bend - 1.0};
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(std::abs(error[i]), last[i]);
      last[i] = std::abs(error[i]);
      if (level == 2) {
        EXPECT_LE(last[i], gate[i]);
      }
    }
  }
}

TEST(WholeBar, StretchedProfileJoinsItsParts) {
  for (int parts : {4, 7, 13}) {
    EXPECT_NEAR(stretched(parts, 0.0).second, 0.5, 1e-12);
    EXPECT_NEAR(stretched(parts, 0.0).first, 0.0, 1e-12);
    const auto a = stretched(parts, 2.0 - 1e-9), b = stretched(parts, 2.0);
    EXPECT_NEAR(a.first / b.first, 1.0, 1e-6);
    EXPECT_NEAR(a.second, b.second, 1e-4);
    // Far from the plates: Poisson's ratio.
    EXPECT_NEAR(b.first / (whole_bar_stiffness(parts).stretch / prism_section(16, 0.5).area), -0.15, 1e-4);
  }
}

}  // namespace
}  // namespace softpoint::reference

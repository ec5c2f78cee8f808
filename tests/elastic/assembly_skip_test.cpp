// What has not moved is neither solved nor multiplied; the same calls give the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "elastic_support.h"
#include "softpoint/elastic/assembly.h"
#include "support/characters.h"
#include "support/tier.h"

namespace softpoint::elastic {
namespace {

constexpr int kChains = 100, kParts = 7;

Assembly hundred_chains(const AssemblySettings& settings = {}) {
  AssemblyDesign design;
  for (int c = 0; c < kChains; ++c) {
    design.add_row("", cylinder_segment(), kParts, Vec3(2.0 * (c % 10), 2.0 * (c / 10), 0));
  }
  Assembly chains(design, settings);
  for (int c = 0; c < kChains; ++c) {
    chains.hold({c, false}, Hold::kSurface);
    chains.hold({c, true}, Hold::kSurface);
  }
  chains.solve();
  return chains;
}

void swing(Assembly& chains, int chain, double phase) {
  chains.move({chain, true},
              Vec3(2.0 * (chain % 10) + 0.4 * std::sin(phase), 2.0 * (chain / 10) + 0.4 * std::cos(phase),
                   kParts + 0.1 * std::sin(2 * phase)));
}

TEST(Skips, OfAHundredChainsTheOneThatMovesIsSolved) {
  Assembly chains = hundred_chains();
  EXPECT_EQ(chains.report().groups, kChains);
  const std::vector<Vec3> before(chains.points().begin(), chains.points().end());
  swing(chains, 42, 1.0);
  chains.solve();
  const AssemblyReport one = chains.report();
  EXPECT_EQ(one.groups_solved, 1);
  EXPECT_EQ(one.segments_skinned, kParts);
  EXPECT_GT(one.products, 0);
  EXPECT_LE(one.products, static_cast<long long>(kParts) * one.evaluations);
  int moved = 0;
  for (std::size_t p = 0; p < before.size(); ++p) moved += chains.points()[p] != before[p] ? 1 : 0;
  EXPECT_GT(moved, 60 * kParts);
  EXPECT_LE(moved, 65 * kParts + 17);

  for (int c = 0; c < kChains; ++c) swing(chains, c, 1.5);
  chains.solve();
  EXPECT_EQ(chains.report().groups_solved, kChains);
  EXPECT_EQ(chains.report().segments_skinned, kChains * kParts);
}

// The best of many frames each; tried again where the machine is busy.
TEST(Skips, TimeIsAtMostAFiftiethOfAllMoving) {
  if (kInstrumented) GTEST_SKIP() << "of time, not of memory";
  Assembly chains = hundred_chains();
  double ratio = 1;
  for (int attempt = 0; attempt < 8 && ratio > 0.02; ++attempt) {
    double one = 1e9, all = 1e9;
    for (int frame = 0; frame < 12; ++frame) {
      const double phase = 0.05 * (12 * attempt + frame);
      for (int c = 0; c < kChains; ++c) swing(chains, c, phase);
      chains.solve();
      ASSERT_EQ(chains.report().groups_solved, kChains);
      all = std::min(all, chains.report().solve_seconds + chains.report().skin_seconds);
      swing(chains, 17, phase + 0.02);
      chains.solve();
      ASSERT_EQ(chains.report().groups_solved, 1);
      one = std::min(one, chains.report().solve_seconds + chains.report().skin_seconds);
    }
    ratio = one / all;
  }
  std::printf("    one chain of %d: %.2f %% of the time of all\n", kChains, 100 * ratio);
  EXPECT_LE(ratio, 0.02);
}

TEST(Skips, ASecondSolveCostsNothing) {
  Assembly chains = hundred_chains(AssemblySettings::exact());
  chains.solve();
  const std::vector<Vec3> before(chains.points().begin(), chains.points().end());
  chains.solve();
  EXPECT_EQ(chains.report().groups_solved, 0);
  EXPECT_EQ(chains.report().products, 0);
  EXPECT_EQ(chains.report().segments_skinned, 0);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), chains.points().begin()));
  // Moved to where it is, the same gravity, no pushes: nothing has changed.
  chains.set_gravity(Vec3::Zero());
  chains.clear_pushes();
  chains.move({3, true}, chains.bone(3).back());
  chains.solve();
  EXPECT_EQ(chains.report().groups_solved, 0);
}

TEST(Skips, GravityAndPushesReachTheSkinOfJointsThatStay) {
  Assembly chain(chain_of(1), AssemblySettings::exact());
  chain.hold({0, false}, Hold::kSurface);
  chain.hold({0, true}, Hold::kSurface);
  chain.solve();
  const Vec3 rest = chain.points()[static_cast<std::size_t>(chain.point_of({0, 0, 40}))];
  chain.set_gravity(Vec3(9.81, 0, 0));
  chain.solve();
  const Vec3 sagged = chain.points()[static_cast<std::size_t>(chain.point_of({0, 0, 40}))];
  EXPECT_GT(sagged.x() - rest.x(), 1e-4);
  chain.set_gravity(Vec3::Zero());
  chain.push({0, 0, 40}, Vec3(100, 0, 0));
  chain.solve();
  EXPECT_GT(chain.points()[static_cast<std::size_t>(chain.point_of({0, 0, 40}))].x() - rest.x(), 1e-4);
  chain.clear_pushes();
  chain.solve();
  EXPECT_LT((chain.points()[static_cast<std::size_t>(chain.point_of({0, 0, 40}))] - rest).norm(), 1e-12);
}

// Thirty frames of a figure pulled about.
std::vector<Vec3> played(const AssemblySettings& settings, bool settled) {
  Assembly figure(branched_figure(1e5, {1e4, 500, 0, 0}), settings);
  figure.hold({0, false}, Hold::kSurface);
  figure.hold({1, true}, Hold::kPoint);
  figure.set_gravity(Vec3(0, 0, -2));
  std::vector<Vec3> trace;
  for (int frame = 0; frame < 30; ++frame) {
    const double t = 0.2 * frame;
    figure.move({1, true}, Vec3(2.4 + 0.1 * std::sin(3 * t), 0.4 * std::sin(t), 0.3 * std::cos(t)));
    figure.push({2, 1, 30}, Vec3(20 * std::sin(t), 10, 0));
    figure.solve();
    if (!settled) trace.insert(trace.end(), figure.points().begin(), figure.points().end());
  }
  if (settled) trace.assign(figure.points().begin(), figure.points().end());
  return trace;
}

TEST(SameCalls, GiveTheSameBits) {
  for (const AssemblySettings& settings : {AssemblySettings{}, AssemblySettings::exact()}) {
    EXPECT_EQ(played(settings, false), played(settings, false));
  }
}

// Positions are of the order of a metre.
TEST(SinglePrecision, AgreesWithDoubleTo1e5) {
  AssemblySettings exact = AssemblySettings::exact(), single = exact;
  single.single_precision = true;
  single.tolerance = 1e-7;
  single.max_iterations = 60;
  const std::vector<Vec3> in_double = played(exact, true), in_single = played(single, true);
  double largest = 0;
  for (std::size_t p = 0; p < in_double.size(); ++p) {
    largest = std::max(largest, (in_single[p] - in_double[p]).norm());
  }
  std::printf("    single against double precision: %.2g m of 5 m\n", largest);
  EXPECT_LT(largest, 1e-5);
}

TEST(SinglePrecision, ForcesAgreeWithDoubleTo1e5) {
  const auto force = [](bool single) {
    AssemblySettings settings = AssemblySettings::exact();
    settings.single_precision = single;
    if (single) settings.tolerance = 1e-7;
    settings.max_iterations = 200;
    Assembly chain(chain_of(7), settings);
    chain.hold({0, false}, Hold::kSurface);
    chain.hold({0, true}, Hold::kSurface);
    chain.move({0, true}, Vec3(1, 0.5, 7.4), turned_about(Vec3::UnitZ(), 0.5));
    chain.solve();
    return chain.force({0, true});
  };
  const Vec3 in_double = force(false), in_single = force(true);
  EXPECT_LT((in_single - in_double).norm(), 1e-5 * in_double.norm());
}

// Coarser dials are nearer to the exact answer of the same strains the more they spend.
TEST(Dial, MoreBudgetIsNearer) {
  const auto error_with = [](int iterations) {
    AssemblySettings settings = AssemblySettings::exact();
    settings.surface_turns = false;
    Assembly exact(chain_of(7), settings), coarse(chain_of(7), AssemblySettings::budget(iterations));
    for (Assembly* chain : {&exact, &coarse}) {
      chain->hold({0, false}, Hold::kSurface);
      chain->hold({0, true}, Hold::kSurface);
      for (int i = 1; i <= 10; ++i) {
        chain->move({0, true}, Vec3(0.2 * i, 0, 7 - 0.05 * i), turned_about(Vec3::UnitY(), 0.05 * i));
        chain->solve();
      }
    }
    double largest = 0;
    for (std::size_t p = 0; p < exact.points().size(); ++p) {
      largest = std::max(largest, (exact.points()[p] - coarse.points()[p]).norm());
    }
    EXPECT_LE(coarse.report().iterations, iterations);
    return largest;
  };
  const double one = error_with(1), three = error_with(3), ten = error_with(10);
  std::printf("    1, 3, 10 iterations a frame: %.2g, %.2g, %.2g m off\n", one, three, ten);
  EXPECT_LT(three, one);
  EXPECT_LT(ten, three);
  EXPECT_LT(ten, 1e-3);
}

}  // namespace
}  // namespace softpoint::elastic

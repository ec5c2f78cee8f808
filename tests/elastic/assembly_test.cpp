// Assemblies of joined parts: counts, balance, forces at their holders, and the two methods.
#include <gtest/gtest.h>

#include <cmath>

#include "elastic_support.h"
#include "softpoint/elastic/assembly.h"
#include "support/characters.h"
#include "support/refusal.h"

namespace softpoint::elastic {
namespace {

Assembly held_chain(int count, const AssemblySettings& settings = AssemblySettings::exact()) {
  Assembly chain(chain_of(count), settings);
  chain.hold(kRoot, Hold::kSurface);
  chain.hold(kTip, Hold::kSurface);
  return chain;
}

// Table 1 of the paper.
TEST(Assembly, HasThePapersVerticesAndPolygons) {
  const int table[][3] = {
      {10, 658, 1312}, {30, 1938, 3872}, {50, 3218, 6432}, {70, 4498, 8992}, {100, 6418, 12832}};
  for (const auto& [parts, vertices, triangles] : table) {
    const Assembly chain(chain_of(parts));
    EXPECT_EQ(chain.visible_points(), vertices);
    EXPECT_EQ(static_cast<int>(chain.faces().size()), triangles);
    EXPECT_EQ(static_cast<int>(chain.points().size()), 65 * parts + 17);  // with the hidden centres
    for (const Triangle& t : chain.faces()) {
      for (const int v : t) ASSERT_LT(v, vertices);
    }
  }
}

TEST(Assembly, BranchedSkinIsClosed) {
  const Assembly figure(branched_figure());
  TriangleMesh skin;
  skin.vertices.assign(figure.points().begin(), figure.points().begin() + figure.visible_points());
  skin.triangles.assign(figure.faces().begin(), figure.faces().end());
  EXPECT_NEAR(check_closed(skin, "skin").volume, 1.5 + 4 * 0.25, 1e-12);
  EXPECT_NEAR(figure.volume(), 2.5, 1e-12);
}

enum class Motion { stretch, bend, twist };

// The tip where a bar of constant curvature would have it, in `steps` stages.
void lead(Assembly& chain, int count, Motion motion, double amount, int steps) {
  for (int i = 1; i <= steps; ++i) {
    const double part = amount * i / steps;
    Vec3 at(0, 0, count);
    Mat3 turn = Mat3::Identity();
    if (motion == Motion::stretch) at.z() += part * count;
    if (motion == Motion::bend) {
      at = Vec3(count / part * (1 - std::cos(part)), 0, count / part * std::sin(part));
      turn = turned_about(Vec3::UnitY(), part);
    }
    if (motion == Motion::twist) turn = turned_about(Vec3::UnitZ(), part);
    chain.move(kTip, at, turn);
    chain.solve();
  }
}

struct Led {
  Motion motion;
  double amount;
  const char* name;
};

TEST(ExactDial, LeavesNoResidual) {
  for (const int count : {7, 13}) {
    for (const Led& led : {Led{Motion::stretch, 0.1, "stretch"}, Led{Motion::bend, kPi, "bend"},
                           Led{Motion::twist, kPi / 2, "twist"}}) {
      Assembly chain = held_chain(count);
      lead(chain, count, led.motion, led.amount, 6);
      const AssemblyReport& report = chain.report();
      std::printf("    %d parts, %s: residual %.2g, %d iterations\n", count, led.name, report.residual,
                  report.iterations);
      EXPECT_LE(report.residual, 1e-10) << count << " parts, " << led.name;
      EXPECT_TRUE(report.balanced);
      EXPECT_LT(chain.quality().gap, 1e-12 * count);
      // Both holders in balance, moments about one point too.
      const double scale = chain.force(kTip).norm() + chain.moment(kTip).norm() / count;
      EXPECT_LT((chain.force(kTip) + chain.force(kRoot)).norm(), 1e-9 * scale);
      const Vec3 arm = chain.bone(0).back() - chain.bone(0).front();
      EXPECT_LT((chain.moment(kTip) + chain.moment(kRoot) + arm.cross(chain.force(kTip))).norm(),
                1e-9 * scale * count);
    }
  }
}

// Forces are the slope of the energy along the motion of the end.
TEST(ExactDial, ForcesAtAHolderAreTheSlopeOfTheEnergy) {
  Assembly chain = held_chain(5);
  lead(chain, 5, Motion::bend, 1.5, 4);
  const Vec3 at = chain.bone(0).back();
  const Vec3 force = chain.force(kTip);
  const double h = 1e-4;
  for (int axis = 0; axis < 3; ++axis) {
    const auto energy_at = [&](double shift) {
      chain.move(kTip, at + shift * Vec3::Unit(axis));
      chain.solve();
      return chain.energy();
    };
    EXPECT_NEAR((energy_at(h) - energy_at(-h)) / (2 * h), force[axis], 1e-5 * force.norm());
  }
}

TEST(ExactDial, TurnedAssembliesAnswerTurned) {
  const Mat3 turn = turned_about(Vec3(1, -2, 0.5), 2.0);
  const Vec3 origin(3, -4, 5);
  Assembly straight = held_chain(4), other(chain_of(4), AssemblySettings::exact(), origin, turn);
  other.hold(kRoot, Hold::kSurface);
  other.hold(kTip, Hold::kSurface);
  const Vec3 to(0.8, 0.3, 3.5);
  const Mat3 twist = turned_about(Vec3(1, 1, 1), 0.7);
  straight.move(kTip, to, twist);
  straight.solve();
  other.move(kTip, turn * to + origin, turn * twist * turn.transpose());
  other.solve();
  EXPECT_LT((other.force(kTip) - turn * straight.force(kTip)).norm(), 1e-8 * straight.force(kTip).norm());
  EXPECT_LT((other.moment(kTip) - turn * straight.moment(kTip)).norm(), 1e-8 * straight.moment(kTip).norm());
  for (std::size_t p = 0; p < straight.points().size(); ++p) {
    EXPECT_LT((other.points()[p] - (turn * straight.points()[p] + origin)).norm(), 1e-8);
  }
}

// Equation (4) of the paper goes to the same place.
TEST(Richardson, AgreesWithTheEquilibriumInTheLimit) {
  Assembly exact = held_chain(2);
  AssemblySettings by_equation_4 = AssemblySettings::exact();
  by_equation_4.method = JointMethod::kRichardson;
  by_equation_4.max_iterations = 20000;
  by_equation_4.tolerance = 1e-10;
  Assembly paper = held_chain(2, by_equation_4);
  for (Assembly* chain : {&exact, &paper}) {
    chain->move(kTip, Vec3(0.1, 0, 2.15), turned_about(Vec3(0, 1, 1), 0.3));
    chain->solve();
  }
  EXPECT_TRUE(paper.report().balanced) << paper.report().residual;
  EXPECT_GT(paper.report().iterations, 10 * exact.report().iterations);
  EXPECT_LT((paper.force(kTip) - exact.force(kTip)).norm(), 1e-7 * exact.force(kTip).norm());
  for (std::size_t p = 0; p < exact.points().size(); ++p) {
    EXPECT_LT((paper.points()[p] - exact.points()[p]).norm(), 1e-7);
  }
}

// The limit that a message names: `permitted is 0 to <limit>`.
double greatest_kappa(Assembly& chain) {
  AssemblySettings settings = chain.settings();
  settings.method = JointMethod::kRichardson;
  settings.kappa = 1e6;
  const std::string message = refusal([&] { chain.set_settings(settings); });
  EXPECT_NE(message.find("AssemblySettings.kappa"), std::string::npos) << message;
  return std::stod(message.substr(message.find(" to ") + 4));
}

// Beyond it it diverges: joint_solver_test.cpp.
TEST(Richardson, RefusesAStepBeyondItsLimitByName) {
  Assembly chain = held_chain(4);
  chain.solve();  // factors, so that the limit is known
  const double limit = greatest_kappa(chain);
  EXPECT_GT(limit, 0.0);
  AssemblySettings settings = chain.settings();
  settings.method = JointMethod::kRichardson;
  settings.max_iterations = 300;
  settings.kappa = 0.98 * limit;
  EXPECT_NO_THROW(chain.set_settings(settings));
  chain.move(kTip, Vec3(0, 0, 4.2));
  chain.solve();
  const double first = chain.report().residual;
  chain.solve();
  EXPECT_LT(chain.report().residual, first);

  settings.kappa = 1.05 * limit;
  expect_refusal([&] { chain.set_settings(settings); }, {"AssemblySettings.kappa", "permitted is 0 to"});
  EXPECT_DOUBLE_EQ(chain.settings().kappa, 0.98 * limit);
}

TEST(Assembly, GravityIsCarriedByTheHolders) {
  Assembly figure(branched_figure(), AssemblySettings::exact());
  figure.hold({0, false}, Hold::kSurface);
  figure.set_gravity(Vec3(1, 0, -9.81));
  figure.solve();
  const double mass = 2.5 * 1000.0;
  EXPECT_LT((figure.force({0, false}) + mass * Vec3(1, 0, -9.81)).norm(), 1e-9 * mass * 9.81);
  EXPECT_TRUE(figure.report().balanced);
}

// Figure 13: pulling a leg pulls the torso; at rest what one holder pulls all others hold.
TEST(Branches, AHandsForceIsThatOfAllOtherHolders) {
  for (const BoneSettings& bone : {BoneSettings{}, BoneSettings{2e4, 1e3, 0, 0}}) {
    for (const Hold how : {Hold::kPoint, Hold::kSurface}) {
      Assembly figure(branched_figure(1e5, bone), AssemblySettings::exact());
      figure.hold({0, false}, Hold::kSurface);  // the torso's foot
      figure.hold({1, true}, how);
      figure.hold({2, true}, Hold::kPoint);
      const Vec3 top = figure.bone(0).back();
      for (int i = 1; i <= 4; ++i) {
        figure.move({1, true}, Vec3(2.5, 0, 0) + 0.2 * i * Vec3(0.6, 1.0, 0.4));
        figure.solve();
      }
      EXPECT_TRUE(figure.report().balanced) << figure.report().residual;
      const Vec3 hand = figure.force({1, true});
      const Vec3 others = figure.force({0, false}) + figure.force({2, true});
      EXPECT_GT(hand.norm(), 100.0);
      EXPECT_LE((hand + others).norm(), 1e-9 * hand.norm());
      EXPECT_GT((figure.bone(0).back() - top).norm(), 0.01);  // the torso was moved by its limb
      EXPECT_GT(figure.force({2, true}).norm(), 1e-3 * hand.norm());
      EXPECT_LT(figure.quality().gap, 1e-11);
    }
  }
}

// Balance of moments, of all holders about one point.
TEST(Branches, MomentsBalanceToo) {
  Assembly figure(branched_figure(1e5, {2e4, 1e3, 0, 0}), AssemblySettings::exact());
  const PartEnd ends[] = {{0, false}, {1, true}, {2, true}};
  for (const PartEnd& end : ends) figure.hold(end, Hold::kSurface);
  figure.move({1, true}, Vec3(2.8, 0.4, 0.2), turned_about(Vec3(1, 1, 0), 0.5));
  figure.solve();
  Vec3 sum = Vec3::Zero();
  double scale = 0;
  for (const PartEnd& end : ends) {
    const std::vector<Vec3> bone = figure.bone(end.part);
    const Vec3 moment = figure.moment(end) + (end.tip ? bone.back() : bone.front()).cross(figure.force(end));
    sum += moment;
    scale += moment.norm();
  }
  EXPECT_LT(sum.norm(), 1e-9 * scale);
}

// A push at the skin, on free vertices and on those of a joint, is carried by the holder.
TEST(Assembly, PushesArriveAtTheHolder) {
  Assembly chain(chain_of(3), AssemblySettings::exact());
  chain.hold(kRoot, Hold::kSurface);
  const Vec3 on_free(30, -20, 10), on_joint(5, 15, -25);
  chain.push({0, 1, 40}, on_free);
  chain.push({0, 2, 81}, 2 * on_joint);
  chain.push({0, 2, 81}, on_joint);  // replaces
  const Vec3 before = chain.points()[static_cast<std::size_t>(chain.point_of({0, 1, 40}))];
  chain.solve();
  EXPECT_LT((chain.force(kRoot) + on_free + on_joint).norm(), 1e-8 * on_free.norm());
  const Vec3 moved = chain.points()[static_cast<std::size_t>(chain.point_of({0, 1, 40}))] - before;
  EXPECT_GT(moved.dot(on_free), 0.0);
  chain.clear_pushes();
  chain.solve();
  EXPECT_LT(chain.force(kRoot).norm(), 1e-5);
  EXPECT_LT((chain.points()[static_cast<std::size_t>(chain.point_of({0, 1, 40}))] - before).norm(), 1e-7);
}

}  // namespace
}  // namespace softpoint::elastic

// The solver of joints below the public interface: convergence of equation (4), and the compliance.
#include <gtest/gtest.h>

#include "elastic_support.h"
#include "joint_solver.h"
#include "part_mechanics.h"
#include "support/characters.h"

namespace softpoint::elastic {
namespace {

struct Solving : Mechanics {
  explicit Solving(const AssemblyDesign& given)
      : Mechanics(given),
        solver(group, kernels_for(choose_instruction_set(InstructionSet::kAvx512)), false),
        held(static_cast<std::size_t>(group.points()), 0),
        inertia(Vector::Zero(group.points())) {
    // The first joint, and the last one.
    for (const PartGroup::Joint* joint : {&group.joints().front(), &group.joints().back()}) {
      for (Eigen::Index i = 0; i < joint->count; ++i) held[static_cast<std::size_t>(joint->first + i)] = 1;
    }
    solver.prepare(held, inertia);
  }
  JointSolver solver;
  std::vector<char> held;
  Vector inertia;
};

// The rest pose with the last joint pulled by 1 %.
Vector pulled(const PartGroup& group) {
  Vector x = group.rest();
  const PartGroup::Joint& tip = group.joints().back();
  for (Eigen::Index i = 0; i < tip.count; ++i) x[3 * tip.first + 2 * tip.count + i] += 0.01;
  return x;
}

TEST(JointSolver, GreatestStiffnessIsTheGreatestEigenvalue) {
  Solving s(chain_of(3));
  const Eigen::Index n = s.group.size();
  Matrix k(n, n);
  Vector column(n), ignored(n);
  s.group.evaluate(s.group.rest(), ignored);
  for (Eigen::Index i = 0; i < n; ++i) {
    s.group.stiffness_product(Vector::Unit(n, i), column);
    k.col(i) = column;
  }
  for (const PartGroup::Joint& joint : s.group.joints()) {
    for (Eigen::Index i = 0; i < 3 * joint.count; ++i) {
      if (s.held[static_cast<std::size_t>(joint.first + i % joint.count)] == 0) continue;
      k.row(3 * joint.first + i).setZero();
      k.col(3 * joint.first + i).setZero();
    }
  }
  const Vector values = Eigen::SelfAdjointEigenSolver<Matrix>(k).eigenvalues();
  EXPECT_NEAR(s.solver.greatest_stiffness(), values[n - 1], 0.02 * values[n - 1]);
}

// dx = kappa (-F1 - F2) has a limit, 2 over the greatest stiffness: it shrinks every error below it and lets
// one grow above.
TEST(JointSolver, Equation4ConvergesBelowItsLimitAndDivergesAbove) {
  AssemblySettings settings = AssemblySettings::exact();
  Solving exact(chain_of(3));
  Vector balance = pulled(exact.group);
  ASSERT_TRUE(exact.solver.solve(settings, 0, balance, exact.group.rest()).balanced);
  settings.method = JointMethod::kRichardson;
  settings.max_iterations = 600;
  const auto error_after = [&](double part_of_limit) {
    Solving s(chain_of(3));
    Vector x = pulled(s.group);
    s.solver.solve(settings, part_of_limit * 2.0 / s.solver.greatest_stiffness(), x, s.group.rest());
    return (x - balance).norm();
  };
  const double before = (pulled(exact.group) - balance).norm();
  const double half = error_after(0.5), near = error_after(0.95), beyond = error_after(1.05);
  std::printf(
      "    %.3g m from balance; 600 iterations on, %.3g, %.3g, %.3g m at 0.5, 0.95, 1.05 of the limit\n",
      before, half, near, beyond);
  EXPECT_LT(half, 1e-3 * before);
  EXPECT_LT(near, 1e-3 * before);
  EXPECT_GT(beyond, 3 * before);
}

// At a bent shape, with and without forces of bones; of one load and of several at once.
void expect_inverse(const elastic::BoneSettings& bone) {
  Solving s(branched_figure(1e5, bone));
  Vector x = s.group.rest(), ignored(s.group.size());
  Noise noise;
  for (double& v : x) v += 0.01 * noise();
  s.solver.evaluate(x, s.group.rest());
  constexpr Eigen::Index kLoads = 11;
  Eigen::MatrixXd force(kLoads, s.group.size());
  for (double& v : force.reshaped()) v = noise();
  const auto mask = [&](auto&& v) {
    for (const PartGroup::Joint& joint : s.group.joints()) {
      for (Eigen::Index i = 0; i < 3 * joint.count; ++i) {
        if (s.held[static_cast<std::size_t>(joint.first + i % joint.count)] != 0) v[3 * joint.first + i] = 0;
      }
    }
  };
  Eigen::MatrixXd shift = force;
  std::vector<double> scratch;
  s.solver.respond(shift.data(), kLoads, kLoads, scratch);
  for (Eigen::Index k = 0; k < kLoads; ++k) {
    Vector load = force.row(k), moved = shift.row(k), back(s.group.size());
    mask(load);
    s.group.stiffness_product(moved, back);
    back += s.solver.steady() * moved;
    mask(back);
    EXPECT_LT((back - load).norm(), 1e-9 * load.norm());
    Vector held = moved;
    mask(held);
    EXPECT_EQ(held, moved);
  }
}

TEST(JointSolver, RespondIsTheInverseOfTheStiffness) {
  expect_inverse({});
  expect_inverse({3e4, 2e3, 0, 0});
}

}  // namespace
}  // namespace softpoint::elastic

// Forces of bones, (5) and (6) of the paper, and cyclic coordinate descent.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>

#include "bone_energy.h"
#include "elastic_support.h"
#include "inverse_kinematics.h"
#include "support/characters.h"

namespace softpoint::elastic {
namespace {

std::vector<Vec3> straight(int bones, double length = 1.0) {
  std::vector<Vec3> joints;
  for (int i = 0; i <= bones; ++i) joints.emplace_back(0, 0, length * i);
  return joints;
}

std::vector<double> lengths_of(std::span<const Vec3> joints) {
  std::vector<double> lengths;
  for (std::size_t i = 1; i < joints.size(); ++i) lengths.push_back((joints[i] - joints[i - 1]).norm());
  return lengths;
}

std::vector<Vec3> gradient_of(const BoneSettings& bone, const BoneShape& shape, std::span<const Vec3> joints,
                              double* energy = nullptr) {
  std::vector<Vec3> gradient(joints.size(), Vec3::Zero());
  const double e = bone_energy(bone, shape, joints, gradient);
  if (energy != nullptr) *energy = e;
  return gradient;
}

// F_li = alpha (L_i - l_i)(X_i-1 - X_i)/L_i + beta (L_i+1 - l_i+1)(X_i+1 - X_i)/L_i+1.
TEST(BoneForces, OfLengthAreEquation5) {
  const double k = 7e3;
  const BoneShape shape = bone_shape(straight(4, 0.8));
  std::vector<Vec3> joints = straight(4, 0.8);
  Noise noise;
  for (Vec3& x : joints) x += 0.3 * Vec3(noise(), noise(), noise());
  const std::vector<Vec3> gradient = gradient_of({k, 0, 0, 0}, shape, joints);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Vec3 force = Vec3::Zero();
    for (const std::size_t other : {i - 1, i + 1}) {
      if (other >= joints.size()) continue;
      const Vec3 to = joints[other] - joints[i];
      force += k * (to.norm() - 0.8) * to / to.norm();
    }
    EXPECT_LT((gradient[i] + force).norm(), 1e-12 * k) << "joint " << i;
  }
}

// Two bones of rest length that turn by an angle: F = c/L_i (theta - theta_0) N_i + c/L_i+1 (...) N_i+1 at
// their joint, the opposite terms at its neighbours.
TEST(BoneForces, OfAngleAreEquation6) {
  const double c = 50, before = 0.7, after = 1.3;
  const std::vector<Vec3> rest = {Vec3(0, 0, 0), Vec3(0, 0, before), Vec3(0, 0, before + after)};
  const BoneShape shape = bone_shape(rest);
  ASSERT_EQ(shape.angles.size(), 1u);
  EXPECT_EQ(shape.angles[0], 0.0);
  for (const double theta : {0.05, 0.5, 1.5, 3.0}) {
    const Vec3 along(std::sin(theta), 0, std::cos(theta));
    const std::vector<Vec3> joints = {rest[0], rest[1], rest[1] + after * along};
    const std::vector<Vec3> gradient = gradient_of({0, c, 0, 0}, shape, joints);
    // Unit normals of the bones in their plane, on the inner side of the bend, where the joint is pushed.
    const Vec3 n_before(1, 0, 0), n_after(std::cos(theta), 0, -std::sin(theta));
    const Vec3 at_before = c / before * theta * n_before, at_after = c / after * theta * n_after;
    const std::vector<Vec3> forces = {-at_before, at_before + at_after, -at_after};
    // Across the bones; along them a force that vanishes with theta^2 takes the hold off bones that fold.
    EXPECT_NEAR(-gradient[0].dot(n_before), forces[0].dot(n_before), 1e-11 * c) << theta;
    EXPECT_NEAR(-gradient[2].dot(n_after), forces[2].dot(n_after), 1e-11 * c) << theta;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT((gradient[i] + forces[i]).norm(), 0.02 * theta * theta * c / before) << theta;
    }
  }
}

TEST(BoneForces, AreTheGradientOfTheirEnergyAndBalance) {
  Noise noise;
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<Vec3> rest = straight(5, 0.6), joints = rest;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      rest[i] += 0.2 * Vec3(noise(), noise(), noise());  // bent at rest
      joints[i] += 0.4 * Vec3(noise(), noise(), noise());
    }
    const BoneSettings bone{5e3, 300, 0, 0};
    const BoneShape shape = bone_shape(rest);
    const std::vector<Vec3> gradient = gradient_of(bone, shape, joints);
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    double scale = 0;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      force += gradient[i];
      moment += joints[i].cross(gradient[i]);
      scale += gradient[i].norm();
      for (int a = 0; a < 3; ++a) {
        const auto energy_at = [&](double h) {
          std::vector<Vec3> moved = joints;
          moved[i][a] += h;
          double energy = 0;
          gradient_of(bone, shape, moved, &energy);
          return energy;
        };
        const double h = 1e-5;
        const double wide = (energy_at(2 * h) - energy_at(-2 * h)) / (4 * h);
        const double narrow = (energy_at(h) - energy_at(-h)) / (2 * h);
        ASSERT_NEAR((4 * narrow - wide) / 3, gradient[i][a], 2e-6 * scale + 1e-3) << "trial " << trial;
      }
    }
    EXPECT_LT(force.norm(), 1e-12 * scale);
    EXPECT_LT(moment.norm(), 1e-11 * 4 * scale);
  }
}

TEST(BoneForces, StayFiniteWhereBonesAreFoldedToNothing) {
  const BoneSettings bone{1e5, 1e4, 0, 0};
  const BoneShape shape = bone_shape(straight(3));
  const std::vector<std::vector<Vec3>> folded = {
      {Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 0)},
      {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, 0), Vec3(0, 0, 1)},  // flat on itself
      {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(1, 0, 1)},
      {Vec3(0, 0, 0), Vec3(0, 0, 1e-200), Vec3(1e-200, 0, 0), Vec3(1, 0, 1)},
      {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(1e-14, 0, 2), Vec3(0, 0, 3)}};
  for (const auto& joints : folded) {
    double energy = 0;
    for (const Vec3& g : gradient_of(bone, shape, joints, &energy)) EXPECT_TRUE(g.allFinite());
    EXPECT_TRUE(std::isfinite(energy));
  }
}

TEST(Reach, MeetsTargetsInReachAndKeepsLengths) {
  Noise noise;
  int reached = 0;
  constexpr int kTargets = 200;
  for (int trial = 0; trial < kTargets; ++trial) {
    std::vector<Vec3> joints = straight(6, 0.5);
    for (Vec3& x : joints) x += 0.05 * Vec3(noise(), noise(), noise());
    joints[0].setZero();
    const std::vector<double> before = lengths_of(joints);
    const Vec3 target = 2.5 * std::cbrt(std::abs(noise())) * Vec3(noise(), noise(), noise()).normalized();
    const int sweeps = reach(joints, target, 200, 1e-3);
    reached += (joints.back() - target).norm() <= 1e-3 ? 1 : 0;
    EXPECT_LE(sweeps, 200);
    EXPECT_EQ(joints[0], Vec3::Zero().eval());
    const std::vector<double> after = lengths_of(joints);
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-12);
  }
  std::printf("    %d of %d targets within 1 mm\n", reached, kTargets);
  EXPECT_EQ(reached, kTargets);
}

TEST(Reach, StopsAtItsToleranceAndAtItsBudget) {
  std::vector<Vec3> joints = straight(4);
  EXPECT_EQ(reach(joints, joints.back() + Vec3(0, 0, -1e-4), 50, 1e-3), 0);
  EXPECT_EQ(joints, straight(4));
  EXPECT_EQ(reach(joints, Vec3(9, 0, 0), 7, 1e-3), 7);
  EXPECT_EQ(reach(joints, Vec3(1, 1, 1), 0, 1e-3), 0);
}

TEST(PlaceBone, LengthensTheLastBoneAloneWhereTheTargetIsOutOfReach) {
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0.3, -0.5, -0.4)}) {
    std::vector<Vec3> joints = straight(5, 0.4);
    const std::vector<double> before = lengths_of(joints);
    const Vec3 root(1, 2, 3), target = root + 4.0 * direction.normalized();
    place_bone(joints, root, target, 100, 1e-4);
    EXPECT_EQ(joints.front(), root);
    EXPECT_EQ(joints.back(), target);
    const std::vector<double> after = lengths_of(joints);
    for (std::size_t i = 0; i + 1 < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-12);
    EXPECT_GT(after.back(), before.back() + 1.5);
  }
}

TEST(PlaceBone, InReachNoLengthChangesByMoreThanTheTolerance) {
  std::vector<Vec3> joints = straight(5, 0.4);
  const std::vector<double> before = lengths_of(joints);
  place_bone(joints, Vec3(0, 0, 0.5), Vec3(0.7, 0.5, 1.0), 200, 1e-4);
  const std::vector<double> after = lengths_of(joints);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 1.01e-4);
}

TEST(PlaceBone, FoldedBonesAndTargetsOnJointsStayFinite) {
  for (const Vec3& target : {Vec3(0, 0, 0), Vec3(0, 0, 0.4), Vec3(0, 0, -2), Vec3(0, 0, 2)}) {
    for (const bool folded : {false, true}) {
      std::vector<Vec3> joints = folded ? std::vector<Vec3>(6, Vec3::Zero()) : straight(5, 0.4);
      place_bone(joints, Vec3::Zero(), target, 30, 1e-6);
      for (const Vec3& x : joints) EXPECT_TRUE(x.allFinite());
    }
  }
}

}  // namespace
}  // namespace softpoint::elastic

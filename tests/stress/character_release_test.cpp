// Characters that were pulled, turned and let go find back to their shape.
#include <gtest/gtest.h>

#include <Eigen/SVD>

#include <cmath>
#include <limits>
#include <string>

#include "softpoint/core/deformable_system.h"
#include "softpoint/elastic/character.h"
#include "support/characters.h"
#include "support/precision.h"
#include "support/random.h"
#include "support/tier.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::AssemblySettings;
using elastic::BoneSettings;
using elastic::Character;
using elastic::CharacterSettings;
using elastic::Hold;
using elastic::PartEnd;

// Largest distance of points from `rest` moved as a rigid body (m).
double distance_from_rest(std::span<const Vec3> points, const std::vector<Vec3>& rest) {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  for (std::size_t p = 0; p < rest.size(); ++p) {
    a += points[p] / static_cast<double>(rest.size());
    b += rest[p] / static_cast<double>(rest.size());
  }
  Mat3 moment = Mat3::Zero();
  for (std::size_t p = 0; p < rest.size(); ++p) moment += (points[p] - a) * (rest[p] - b).transpose();
  const Eigen::JacobiSVD<Mat3> svd(moment, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  const Mat3 turn = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  double largest = 0;
  for (std::size_t p = 0; p < rest.size(); ++p) {
    largest = std::max(largest, (points[p] - a - turn * (rest[p] - b)).norm());
  }
  return largest;
}

// Without gravity and contact, let go after a drag: the shape at rest, moved as a rigid body. Without mass
// this needs a solve or a few; with mass (one end still held, or it would spin on) implicit Euler takes the
// motion out, of soft bodies within longer than ten seconds.
TEST(ReleasedCharacter, ReturnsToItsShape) {
  int returned = 0, runs = 0;
  for (int seed = 0; seed < by_tier(200, 12, 2); ++seed) {
    Random random(static_cast<std::uint64_t>(seed) + 1000);
    const bool inertia = seed % 3 == 2, branched = random.unit() < 0.5;
    const double young = std::pow(10.0, inertia ? random.between(8, 10) : random.between(3, 10));
    const double dt = inertia ? random.between(1.0 / 60, 1.0 / 15) : random.between(1.0 / 1000, 1.0 / 15);
    BoneSettings bone;
    if (random.unit() < 0.5) bone = {0.1 * young, 0.01 * young, 0, 0};
    TestWorld world;
    world->setGravity(btVector3(0, 0, 0));
    DeformableSystem system(*world);
    CharacterSettings settings;
    settings.inertia = inertia;
    settings.joints.single_precision = false;
    Character character(branched ? branched_figure(young, bone) : chain_of(4, cylinder_segment(young), bone),
                        settings);
    character.setActivationState(DISABLE_DEACTIVATION);
    system.add(character);
    const std::vector<Vec3> rest(character.points().begin(), character.points().end());
    const PartEnd root = {0, false}, tip = {branched ? 1 : 0, true};
    character.hold(root, Hold::kSurface);
    character.hold(tip, Hold::kSurface);
    const std::vector<Vec3> joints = character.assembly().bone(tip.part);
    Vec3 at = joints.back();
    const Vec3 way = random.vector(1.0).normalized();
    const Vec3 axis = random.vector(1.0) + Vec3(0, 0, 1e-3);
    const double angle = random.between(-2.0, 2.0), speed = random.between(0, 50);
    const double far = random.between(0.2, 2.5);
    for (int i = 1; i <= 30; ++i) {
      const double gone = std::min(far, speed * dt * i);
      character.move(tip, at + gone * way, turned_about(axis, angle * gone / far));
      world.step(1, dt);
    }
    EXPECT_GT(distance_from_rest(character.points(), rest), 1e-4);
    if (!inertia) character.release(root);  // with mass it would spin on, stretched by that
    character.release(tip);
    character.set_joint_settings([&] {
      AssemblySettings exact = AssemblySettings::exact();
      exact.max_iterations = 200;
      return exact;
    }());
    double seconds = 0, off = 1;
    while (seconds < 10.0 && off > 1e-7) {
      world.step(1, dt);
      seconds += dt;
      off = distance_from_rest(character.points(), rest);
    }
    ++runs;
    returned += off <= 1e-6 ? 1 : 0;
    EXPECT_LE(off, 1e-6) << "seed " << seed << ", E " << young << ", dt " << dt
                         << (inertia ? ", inertia" : "") << (branched ? ", branched" : "") << ", after "
                         << seconds << " s";
    EXPECT_EQ(system.profile().totals.guard_fired, 0);
  }
  std::printf("    %d of %d returned\n", returned, runs);
}

}  // namespace
}  // namespace softpoint

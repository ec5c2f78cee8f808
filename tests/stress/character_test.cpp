// Characters dragged about without mercy: hands at up to 50 m/s and out of reach, bones folded to nothing,
// handles on the skin, any modulus and step; afterwards they find back to their shape.
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

// 20 scenes of 100 steps, 500 of 200 in the long tier.
constexpr int kBlock = 5, kBlocks = 4, kFullBlocks = 100, kSteps = 100, kFullSteps = 200;

struct Outcome {
  std::string complaint;  // empty when all is well
  int balanced = 0, steps = 0;
};

// Hands that wander: places at most `speed` dt apart.
struct Hand {
  PartEnd end;
  Vec3 at, aim;
};

Outcome drag(std::uint64_t seed, int steps) {
  Random random(seed);
  const double young = std::pow(10.0, random.between(3, 10));
  const double dt = 1.0 / std::pow(10.0, random.between(std::log10(15.0), 3.0));
  const bool inertia = random.unit() < 0.5;
  BoneSettings bone;
  if (random.unit() < 0.5) bone = {young * random.unit(), 0.1 * young * random.unit(), 0, 0};
  const bool branched = random.unit() < 0.5;
  TestWorld world(static_cast<WorldKind>(random.below(5)));
  const bool on_floor = random.unit() < 0.5;
  if (on_floor) world.add_floor(-3.0);
  world.add_box(Vec3(0.3, 0.3, 0.3), std::pow(10.0, random.between(0, 3)), Vec3(0, -2.5, 2.0));
  DeformableSystem system(*world);
  CharacterSettings settings;
  settings.inertia = inertia;
  Character character(branched ? branched_figure(young, bone) : chain_of(4, cylinder_segment(young), bone),
                      settings);
  character.setActivationState(DISABLE_DEACTIVATION);
  system.add(character);
  const int points = static_cast<int>(character.points().size());
  std::vector<Hand> hands;
  const std::vector<PartEnd> ends = branched ? std::vector<PartEnd>{{0, false}, {1, true}, {2, true}}
                                             : std::vector<PartEnd>{{0, false}, {0, true}};
  std::vector<HandleId> handles;
  Outcome outcome;
  const auto where = [&](const PartEnd& end) {
    const std::vector<Vec3> joints = character.assembly().bone(end.part);
    return end.tip ? joints.back() : joints.front();
  };
  for (int i = 0; i < steps && outcome.complaint.empty(); ++i) {
    if (random.unit() < 0.15 || (hands.empty() && !inertia)) {
      const PartEnd end = ends[static_cast<std::size_t>(random.below(static_cast<int>(ends.size())))];
      const bool held = character.assembly().held(end) != Hold::kNothing;
      if (held && (hands.size() > 1 || inertia) && random.unit() < 0.3) {
        character.release(end);
        std::erase_if(hands, [&](const Hand& h) { return h.end.part == end.part && h.end.tip == end.tip; });
      } else if (!held) {
        character.hold(end, random.unit() < 0.5 ? Hold::kPoint : Hold::kSurface);
        hands.push_back({end, where(end), where(end)});
      }
    }
    for (Hand& hand : hands) {
      if (random.unit() < 0.1) {
        hand.aim = random.vector(random.unit() < 0.3 ? 20.0 : 4.0);
        // Onto another end: the bone between is folded to nothing.
        if (random.unit() < 0.3)
          hand.aim = where(ends[static_cast<std::size_t>(random.below(static_cast<int>(ends.size())))]);
      }
      const Vec3 way = hand.aim - hand.at;
      const double reach = random.between(0, 50) * dt;
      hand.at += way.norm() > reach ? Vec3(way * (reach / way.norm())) : way;
      if (random.unit() < 0.7) {
        character.move(hand.end, hand.at);
      } else {
        character.move(hand.end, hand.at,
                       turned_about(random.vector(1) + Vec3(1e-3, 0, 0), random.between(-3, 3)));
      }
    }
    if (random.unit() < 0.05) {
      const double force = random.unit() < 0.5 ? std::numeric_limits<double>::infinity()
                                               : std::pow(10.0, random.between(0, 6));
      handles.push_back(system.grab(character, random.below(points), random.vector(4.0), force));
    }
    for (const HandleId h : handles) {
      if (random.unit() < 0.5) system.move(h, random.vector(4.0));
    }
    if (!handles.empty() && random.unit() < 0.1) {
      system.release(handles.back());
      handles.pop_back();
    }
    world.step(1, dt);
    ++outcome.steps;
    outcome.balanced += character.assembly().report().balanced ? 1 : 0;
    for (const Vec3& p : character.points()) {
      if (!p.allFinite()) outcome.complaint = "point not finite";
    }
    for (const Vec3& v : character.velocities()) {
      if (!v.allFinite()) outcome.complaint = "velocity not finite";
    }
    for (const Hand& hand : hands) {
      if (!character.end_force(hand.end).allFinite()) outcome.complaint = "hand's force not finite";
    }
    for (const HandleId h : handles) {
      if (!system.handle_force(h).allFinite()) outcome.complaint = "handle's force not finite";
    }
    for (const ContactPoint& c : system.contacts()) {
      if (!c.force.allFinite()) outcome.complaint = "contact force not finite";
    }
    if (!std::isfinite(character.elastic_energy())) outcome.complaint = "energy not finite";
    if (system.profile().totals.guard_fired != 0) outcome.complaint = "guard fired";
    if (!outcome.complaint.empty()) outcome.complaint += " at step " + std::to_string(i);
  }
  if (!outcome.complaint.empty()) {
    outcome.complaint += "; seed " + std::to_string(seed) + ", E " + std::to_string(young) + ", dt " +
                         std::to_string(dt) + (inertia ? ", inertia" : "") + (branched ? ", branched" : "");
  }
  return outcome;
}

class CharacterDrags : public ::testing::TestWithParam<int> {};

TEST_P(CharacterDrags, LeaveEveryNumberFinite) {
  int steps = 0, balanced = 0;
  for (int seed = kBlock * GetParam(); seed < kBlock * (GetParam() + 1); ++seed) {
    const Outcome outcome = drag(static_cast<std::uint64_t>(seed), by_tier(kFullSteps, kSteps, kSteps / 2));
    EXPECT_EQ(outcome.complaint, "");
    steps += outcome.steps;
    balanced += outcome.balanced;
  }
  std::printf("    %d steps, %d of them balanced within the default budget\n", steps, balanced);
}

INSTANTIATE_TEST_SUITE_P(Block, CharacterDrags, ::testing::Range(0, by_tier(kFullBlocks, kBlocks, 1)));

}  // namespace
}  // namespace softpoint

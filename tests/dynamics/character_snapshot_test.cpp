// Characters go on with the same bits: from a snapshot, in a world made anew, in a second run.
#include <gtest/gtest.h>

#include "softpoint/core/deformable_system.h"
#include "softpoint/elastic/character.h"
#include "support/characters.h"
#include "support/state_hash.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::AssemblySettings;
using elastic::Character;
using elastic::CharacterSettings;
using elastic::Hold;

CharacterSettings flying_exactly() {
  CharacterSettings settings;
  settings.joints = AssemblySettings::exact();
  settings.inertia = true;
  return settings;
}

// A figure that flies and lands, one that hangs on hands and is dragged.
struct Stage {
  Stage()
      : floor(world.add_floor()),
        system(*world),
        flying(chain_of(3), flying_exactly(), Vec3(3, 0.8, 0)),
        hanging(branched_figure(), CharacterSettings{}, Vec3(-3, 4, 0)) {
    for (Character* c : {&flying, &hanging}) {
      c->setActivationState(DISABLE_DEACTIVATION);
      system.add(*c);
    }
    hanging.hold({0, false}, Hold::kSurface);
    hanging.hold({1, true}, Hold::kPoint);
    flying.apply_impulse(8, Vec3(1, 0, 0), Vec3(20, 10, 300));
    handle = system.grab(hanging, 30, hanging.points()[30] + Vec3(0.1, 0.1, -0.1), 3000);
  }
  TestWorld world;
  btRigidBody& floor;
  DeformableSystem system;
  Character flying, hanging;
  HandleId handle = 0;
};

TEST(Character, SnapshotsGoOnWithTheSameBits) {
  Stage stage;
  stage.world.step(25);
  stage.hanging.move({1, true}, Vec3(-0.3, 4.3, 0.2));
  stage.flying.apply_impulse(3, Vec3(0.5, 0.25, 0.25), Vec3(0, 100, 0));
  const Snapshot snapshot = stage.system.save();
  const std::uint64_t at_saving = bits_of(stage.system);
  const auto first = play(stage.world, stage.system, 120);
  EXPECT_FALSE(stage.system.contacts().empty());  // it has landed
  stage.system.restore(snapshot);
  EXPECT_EQ(bits_of(stage.system), at_saving);
  EXPECT_EQ(first_difference(first, play(stage.world, stage.system, 120)), -1);
  // Into a world made anew.
  Stage other;
  other.system.restore(snapshot);
  other.system.flush_contact_caches();
  stage.system.restore(snapshot);
  stage.system.flush_contact_caches();
  EXPECT_EQ(first_difference(play(stage.world, stage.system, 120), play(other.world, other.system, 120)), -1);
  EXPECT_EQ(stage.system.profile().totals.guard_fired, 0);
}

TEST(Character, TwoRunsAreTheSameBitForBit) {
  Stage one, two;
  EXPECT_EQ(first_difference(play(one.world, one.system, 90), play(two.world, two.system, 90)), -1);
}

}  // namespace
}  // namespace softpoint

// A state that is saved and restored goes on with the same bits; what is no such state is refused whole.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cstring>
#include <fstream>
#include <memory>

#include "snapshot_bytes.h"
#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/particles.h"
#include "support/pile.h"
#include "support/precision.h"
#include "support/refusal.h"
#include "support/state_hash.h"
#include "support/temporary_folder.h"
#include "support/tier.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

constexpr WorldKind kWorlds[] = {WorldKind::discrete, WorldKind::multibody, WorldKind::soft_rigid,
                                 WorldKind::soft_multibody, WorldKind::deformable};

// A ball that spins in the air on a handle, a cube that lands on a plane, a cylinder that lands on a static
// box: no rigid body that Bullet would have to solve.
struct Alone {
  explicit Alone(WorldKind kind = WorldKind::discrete, double young = 1e5)
      : world(kind),
        floor(world.add_floor()),
        table(world.add_box(Vec3(0.5, 0.2, 0.5), 0, Vec3(3, 0.2, 0))),
        system(*world),
        ball(model_of(Shape::ball, young), Vec3(0, 2, 0)),
        cube(model_of(Shape::cube, young), Vec3(-2, 0.5, 0)),
        part(model_of(Shape::part, young), Vec3(3, 0.9, 0),
             Mat3(Eigen::AngleAxisd(0.4, Vec3(1, 1, 0).normalized()))) {
    for (Deformable* body : {static_cast<Deformable*>(&ball), static_cast<Deformable*>(&cube),
                             static_cast<Deformable*>(&part)}) {
      system.add(*body);
    }
    ball.set_velocity(Vec3(0.3, 0, 0), Vec3(1, 4, -2));
    cube.set_velocity(Vec3(1, 0, 0), Vec3(0, 0, 1));
    handle = system.grab(ball, 7, ball.points()[7] + Vec3(0, 0.2, 0), 2000);
  }

  TestWorld world;
  btRigidBody& floor;
  btRigidBody& table;
  DeformableSystem system;
  ElasticBody ball, cube, part;
  HandleId handle = 0;
};

TEST(Snapshot, GoesOnWithTheSameBits) {
  for (const WorldKind kind : kWorlds) {
    Alone scene(kind);
    scene.world.step(40);
    scene.cube.apply_impulse(3, Vec3(0.5, 0.25, 0.25), Vec3(20, 5, 0));
    const Snapshot snapshot = scene.system.save();
    const std::uint64_t at_saving = bits_of(scene.system);
    const auto first = play(scene.world, scene.system, 600);
    const Vec3 force = scene.system.handle_force(scene.handle);
    scene.system.restore(snapshot);
    EXPECT_EQ(bits_of(scene.system), at_saving);
    EXPECT_EQ(first_difference(first, play(scene.world, scene.system, 600)), -1) << int(kind);
    EXPECT_EQ(scene.system.handle_force(scene.handle), force);
    EXPECT_EQ(scene.system.profile().totals.substeps, 640);

    if (kind != WorldKind::discrete && !full_tier()) {
      continue;
    }
    Alone other(kind);  // made anew; its own caches are empty
    scene.system.restore(snapshot);
    scene.system.flush_contact_caches();
    other.system.restore(read_snapshot(snapshot.bytes()));
    other.system.flush_contact_caches();
    EXPECT_EQ(first_difference(play(scene.world, scene.system, 600), play(other.world, other.system, 600)),
              -1)
        << int(kind);
  }
}

TEST(Snapshot, WithRigidBodiesGoesOnAsItsFlushedTwin) {
  for (const WorldKind kind : kWorlds) {
    for (const double young : {1e5, 1e6}) {
      if (young != 1e5 && kind != WorldKind::discrete && !full_tier()) {
        continue;
      }
      Pile pile(kind, young);
      pile.world.step(45);
      const Snapshot snapshot = pile.system.save(SnapshotScope::world);
      pile.system.flush_contact_caches();
      const auto first = play(pile.world, pile.system, 600);
      pile.system.restore(snapshot);
      EXPECT_EQ(first_difference(first, play(pile.world, pile.system, 600)), -1)
          << "world " << int(kind) << ", E " << young;
      Pile other(kind, young);
      other.world.step(7);
      other.system.restore(read_snapshot(snapshot.bytes()));
      EXPECT_EQ(first_difference(first, play(other.world, other.system, 600)), -1)
          << "world " << int(kind) << ", E " << young << ", made anew";
    }
  }
}

TEST(Snapshot, OfSleepingBodiesSleepsAndWakesTheSame) {
  Pile pile;
  for (int i = 0; i < 600 && !pile.all_asleep(); ++i) {
    pile.world.step();
  }
  ASSERT_TRUE(pile.all_asleep());
  const Snapshot snapshot = pile.system.save(SnapshotScope::world);
  pile.system.flush_contact_caches();
  const auto on = [&](Pile& p) {
    const auto asleep = play(p.world, p.system, 5);
    p.cube.apply_impulse(0, Vec3(1, 0, 0), Vec3(1, 1, 0));
    auto bits = play(p.world, p.system, 100);
    EXPECT_FALSE(p.cube.asleep());
    bits.insert(bits.begin(), asleep.begin(), asleep.end());
    return bits;
  };
  const auto first = on(pile);
  pile.system.restore(snapshot);
  EXPECT_TRUE(pile.all_asleep());
  EXPECT_EQ(first_difference(first, on(pile)), -1);
  Pile other;
  other.system.restore(snapshot);
  EXPECT_TRUE(other.all_asleep());
  EXPECT_EQ(first_difference(first, on(other)), -1);
}

TEST(Snapshot, OfAnchorsGoesOnAsItsFlushedTwin) {
  struct Hanging {
    Hanging()
        : system(*world),
          body(model_of(Shape::part, 1e5), Vec3(0, 1, 0)),
          hook(world.add_box(Vec3(0.1, 0.1, 0.1), 0, Vec3(0, 1.8, 0))),
          load(world.add_box(Vec3(0.1, 0.1, 0.1), 4, Vec3(0.1, 0.3, 0))) {
      system.add(body);
      system.attach(body, 0, hook);
      handle = system.attach(body, 40, load, 200, true);
    }
    TestWorld world;
    DeformableSystem system;
    ElasticBody body;
    btRigidBody& hook;
    btRigidBody& load;
    HandleId handle = 0;
  };
  Hanging scene;
  scene.world.step(30);
  const Snapshot snapshot = scene.system.save(SnapshotScope::world);
  scene.system.flush_contact_caches();
  const auto first = play(scene.world, scene.system, 300);
  const Vec3 force = scene.system.handle_force(scene.handle);
  scene.system.release(scene.handle);
  scene.system.restore(snapshot);
  EXPECT_TRUE(scene.system.holds(scene.handle));
  EXPECT_EQ(first_difference(first, play(scene.world, scene.system, 300)), -1);
  Hanging other;
  other.system.restore(snapshot);
  EXPECT_EQ(first_difference(first, play(other.world, other.system, 300)), -1);
  EXPECT_EQ(other.system.handle_force(other.handle), force);
}

TEST(Snapshot, FlushedWhileAsleepItStillNoticesWhatIsLost) {
  TestWorld world;
  btRigidBody& table = world.add_box(Vec3(0.5, 0.1, 0.5), 0, Vec3(0, -0.1, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0));
  system.add(body);
  world.step(600);
  ASSERT_TRUE(body.asleep());
  system.flush_contact_caches();
  world.step(3);
  EXPECT_TRUE(body.asleep());
  world.erase(table);
  world.step(30);
  EXPECT_FALSE(body.asleep());
  EXPECT_LT(body.center_of_mass().y(), -0.5);
}

TEST(Snapshot, RestoredWhereAColliderHasGoneItLetsGo) {
  TestWorld world;
  btRigidBody& table = world.add_box(Vec3(0.5, 0.1, 0.5), 0, Vec3(0, -0.1, 0));
  btRigidBody& far = world.add_box(Vec3(0.5, 0.1, 0.5), 0, Vec3(50, -0.1, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0));
  system.add(body);
  world.step(600);
  ASSERT_TRUE(body.asleep());
  const Snapshot snapshot = system.save();
  world.erase(table);
  EXPECT_NE(refusal([&] { system.restore(snapshot); }).find("number of collision objects"),
            std::string::npos);
  world.add_box(Vec3(0.5, 0.1, 0.5), 0, Vec3(-50, -0.1, 0));
  system.restore(snapshot);
  world.erase(far);
  world.step(30);
  EXPECT_LT(body.center_of_mass().y(), -0.5);
}

TEST(Snapshot, AnotherTimeStepOfTheBodyIsRestoredToo) {
  Alone scene;
  for (int i = 0; i < 20; ++i) {
    scene.world->stepSimulation(btScalar(1 / 100.0), 0);
  }
  const Snapshot snapshot = scene.system.save();
  const auto on = [&](Alone& s) {
    std::vector<std::uint64_t> bits;
    for (int i = 0; i < 60; ++i) {
      s.world->stepSimulation(btScalar(1 / 100.0), 0);
      bits.push_back(bits_of(s.system));
    }
    return bits;
  };
  scene.system.flush_contact_caches();
  const auto first = on(scene);
  Alone other;
  other.world.step(3);
  other.system.restore(snapshot);
  other.system.flush_contact_caches();
  EXPECT_EQ(first_difference(first, on(other)), -1);
}

TEST(Determinism, TwoRunsOfOneProgramHaveTheSameBits) {
  std::vector<std::uint64_t> first;
  std::vector<std::unique_ptr<char[]>> litter;  // other addresses for everything in the second run
  for (const int run : {0, 1, 2}) {
    auto pile = std::make_unique<Pile>(WorldKind::discrete, 1e5);
    const auto bits = play(pile->world, pile->system, 400);
    first = run == 0 ? bits : first;
    EXPECT_EQ(first_difference(first, bits), -1);
    for (int i = 0; i < 2000; ++i) {
      litter.push_back(std::make_unique<char[]>(std::size_t(16 + 37 * run + 13 * (i % 97))));
      if (i % 3 == run) litter.erase(litter.begin() + i % 50);
    }
  }
}

// What a restoration could have changed.
std::vector<std::byte> everything(const DeformableSystem& system) {
  const Snapshot now = system.save(SnapshotScope::world);
  return {now.bytes().begin(), now.bytes().end()};
}

// A tetrahedron on a plane: a snapshot small enough to harm it in every way.
struct Small {
  Small() : floor(world.add_floor()), system(*world), body(Particles::tetrahedron(Vec3(0, 0.152, 0))) {
    system.add(body);
    handle = system.grab(body, 3, Vec3(0.02, 0.5, 0), 30);
    world.step(20);
  }
  TestWorld world;
  btRigidBody& floor;
  DeformableSystem system;
  Particles body;
  HandleId handle = 0;
};

TEST(SnapshotFile, ReadsBackWhatWasWritten) {
  TemporaryFolder folder;
  const auto path = folder.path() / "state.snapshot";
  Alone scene;
  scene.world.step(30);
  const Snapshot snapshot = scene.system.save(SnapshotScope::world);
  write_snapshot(path, snapshot);
  const Snapshot read = read_snapshot(path);
  ASSERT_EQ(read.bytes().size(), snapshot.bytes().size());
  EXPECT_EQ(std::memcmp(read.bytes().data(), snapshot.bytes().data(), read.bytes().size()), 0);
  EXPECT_EQ(std::memcmp(read.bytes().data(), "STPNSNAP", 8), 0);
  scene.world.step(30);
  scene.system.restore(read);
  const auto again = everything(scene.system);
  ASSERT_EQ(again.size(), snapshot.bytes().size());
  EXPECT_EQ(std::memcmp(again.data(), snapshot.bytes().data(), again.size()), 0);
}

TEST(SnapshotFile, EveryFlippedByteAndEveryTruncationIsRefused) {
  TemporaryFolder folder;
  const auto path = folder.path() / "harmed.snapshot";
  Small scene;
  const Snapshot snapshot = scene.system.save(SnapshotScope::world);
  const std::vector<std::byte> whole(snapshot.bytes().begin(), snapshot.bytes().end());
  scene.world.step(5);
  const auto before = everything(scene.system);
  const auto refused = [&](const std::vector<std::byte>& bytes) {
    try {
      scene.system.restore(read_snapshot(bytes));
    } catch (const Error& error) {
      return std::string(error.what()).starts_with("snapshot: ");
    }
    return false;
  };
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::vector<std::byte> harmed = whole;
    harmed[i] ^= static_cast<std::byte>(1u << (i % 8));
    ASSERT_TRUE(refused(harmed)) << "byte " << i;
    harmed[i] = ~whole[i];
    ASSERT_TRUE(refused(harmed)) << "byte " << i;
  }
  for (std::size_t size = 0; size < whole.size(); ++size) {
    ASSERT_TRUE(refused({whole.begin(), whole.begin() + std::ptrdiff_t(size)})) << size << " bytes";
  }
  std::vector<std::byte> longer = whole;
  longer.resize(whole.size() + 8);
  ASSERT_TRUE(refused(longer));
  EXPECT_EQ(everything(scene.system), before);
  {
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(whole.data()), std::streamsize(whole.size() / 2));
  }
  EXPECT_NE(refusal([&] { read_snapshot(path); }).find("harmed.snapshot: snapshot: its header tells"),
            std::string::npos);
  EXPECT_NE(refusal([&] { read_snapshot(folder.path()); }).find("no file that can be read"),
            std::string::npos);
  scene.system.restore(read_snapshot(whole));
}

TEST(SnapshotFile, ForeignOnesAreRefusedByName) {
  Small scene;
  const Snapshot snapshot = scene.system.save();
  const auto with = [&](SnapshotWord word, std::uint64_t value) {
    std::vector<std::byte> bytes(snapshot.bytes().begin(), snapshot.bytes().end());
    put_word(bytes, word, value);
    if (word != SnapshotWord::checksum) put_word(bytes, SnapshotWord::checksum, snapshot_checksum(bytes));
    return refusal([&] { read_snapshot(bytes); });
  };
  EXPECT_NE(with(SnapshotWord::version, kSnapshotVersion + 1).find("version 2; permitted is 1"),
            std::string::npos);
  EXPECT_NE(with(SnapshotWord::precision, kDouble ? 4 : 8).find("precision"), std::string::npos);
  EXPECT_NE(with(SnapshotWord::magic, 0).find("does not begin"), std::string::npos);
  EXPECT_NE(with(SnapshotWord::size, 8).find("header tells"), std::string::npos);
  EXPECT_NE(with(SnapshotWord::checksum, 0).find("checksum"), std::string::npos);
  EXPECT_NE(refusal([&] { scene.system.restore(Snapshot()); }).find("empty"), std::string::npos);
}

TEST(Snapshot, OfAnotherSystemIsRefusedAndChangesNothing) {
  const auto alone = [](Shape shape, double young, int count, double density = 1000) {
    auto world = std::make_unique<TestWorld>();
    world->add_floor();
    auto system = std::make_unique<DeformableSystem>(**world);
    std::vector<std::unique_ptr<Deformable>> bodies;
    for (int i = 0; i < count; ++i) {
      bodies.push_back(
          std::make_unique<ElasticBody>(model_of(shape, young, 1 / 60.0, density), Vec3(2.0 * i, 0.5, 0)));
      system->add(*bodies.back());
    }
    world->step(40);
    struct Scene {
      std::unique_ptr<TestWorld> world;
      std::vector<std::unique_ptr<Deformable>> bodies;
      std::unique_ptr<DeformableSystem> system;
    };
    return Scene{std::move(world), std::move(bodies), std::move(system)};
  };
  const auto mine = alone(Shape::cube, 1e5, 1);
  const auto before = everything(*mine.system);
  const auto why = [&](const DeformableSystem& other) {
    const Snapshot snapshot = other.save(SnapshotScope::world);
    return refusal([&] { mine.system->restore(snapshot); });
  };
  EXPECT_NE(why(*alone(Shape::cube, 1e5, 2).system).find("number of bodies"), std::string::npos);
  EXPECT_NE(why(*alone(Shape::ball, 1e5, 1).system).find("body 0: number of points"), std::string::npos);
  EXPECT_NE(why(*alone(Shape::cube, 2e5, 1).system).find("Young"), std::string::npos);
  EXPECT_NE(why(*alone(Shape::cube, 1e5, 1, 900).system).find("hash of the masses"), std::string::npos);
  const auto extra = alone(Shape::cube, 1e5, 1);
  extra.world->add_box(Vec3(0.1, 0.1, 0.1), 1, Vec3(5, 5, 5));
  EXPECT_NE(why(*extra.system).find("number of collision objects"), std::string::npos);
  TestWorld plain;
  plain.add_floor();
  DeformableSystem particles(*plain);
  Particles body = Particles::tetrahedron(Vec3(0, 1, 0));
  particles.add(body);
  EXPECT_NE(why(particles).find("kind"), std::string::npos);
  EXPECT_EQ(everything(*mine.system), before);
}

// With a checksum that fits: every word replaced by what a number can be at worst.
TEST(Snapshot, HarmedWithinTheSealItIsRefusedWholeOrSound) {
  Small scene;
  const Snapshot snapshot = scene.system.save(SnapshotScope::world);
  const std::vector<std::byte> whole(snapshot.bytes().begin(), snapshot.bytes().end());
  scene.world.step(5);
  auto before = everything(scene.system);
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  int refused = 0, taken = 0;
  for (std::size_t at = kSnapshotHeader; at < whole.size(); at += 8) {
    for (const std::uint64_t value :
         {std::bit_cast<std::uint64_t>(nan), std::bit_cast<std::uint64_t>(-infinity),
          std::bit_cast<std::uint64_t>(1e300), ~std::uint64_t{0}, std::uint64_t{1} << 40, std::uint64_t{3}}) {
      std::vector<std::byte> harmed = whole;
      put_word(harmed, at, value);
      seal_snapshot(harmed);
      const Snapshot sealed = read_snapshot(harmed);
      bool accepted = true;
      try {
        scene.system.restore(sealed);
      } catch (const Error&) {
        accepted = false;
      }
      if (!accepted) {
        ++refused;
        ASSERT_EQ(everything(scene.system), before) << "word at " << at;
        continue;
      }
      ++taken;
      for (int i = 0; i < 2; ++i) scene.world.step();
      for (const Vec3& p : scene.body.points()) {
        ASSERT_TRUE(p.allFinite()) << "word at " << at;
      }
      scene.system.restore(snapshot);
      before = everything(scene.system);
    }
  }
  std::printf("    %d harmed snapshots refused, %d sound ones taken\n", refused, taken);
  EXPECT_GT(refused, taken);
}

// One hash for every x86-64 machine with this compiler and C library: the instruction set is held down.
TEST(Determinism, AFlightHasItsGoldenBits) {
  elastic::ElasticSettings settings;
  settings.cache.folder = "";
  settings.stiffness.max_instruction_set = elastic::InstructionSet::kBaseline;
  const auto model = elastic::make_elastic_model(mesh_of(Shape::cube), {1e5, 0.3, 1000}, settings);
  TestWorld world;
  DeformableSystem system(*world);
  ElasticBody body(model, Vec3(0, 0.5, 0));
  system.add(body);
  body.set_velocity(Vec3(0.5, 0, 0), Vec3(0, 1, 0));
  body.apply_impulse(5, Vec3(0.5, 0.25, 0.25), Vec3(3, 50, 7));
  const auto bits = play(world, system, 120);
  std::printf("    0x%016llx\n", static_cast<unsigned long long>(bits.back()));
  EXPECT_EQ(bits.back(), kDouble ? 0x838a559785c6a6d8u : 0x19a7b3e9b0c685f4u);
}

}  // namespace
}  // namespace softpoint

// What a Bullet application expects of an object in its world: rays, the mirror, serialization, debug
// drawing.
#include <BulletSoftBody/btSoftBody.h>
#include <LinearMath/btSerializer.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/precision.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

// Brute force over all faces, in double.
std::optional<RayHit> brute_pick(std::span<Deformable* const> bodies, const Vec3& from, const Vec3& to) {
  RayHit best;
  best.fraction = 2;
  for (Deformable* body : bodies) {
    for (std::size_t f = 0; f < body->faces().size(); ++f) {
      const auto at = [&](std::size_t k) {
        return body->points()[static_cast<std::size_t>(body->faces()[f][k])];
      };
      const Vec3 n = (at(1) - at(0)).cross(at(2) - at(0));
      const double den = n.dot(to - from);
      if (std::abs(den) < 1e-15) continue;
      const double t = n.dot(at(0) - from) / den;
      const Vec3 p = from + t * (to - from);
      bool inside = t >= 0 && t <= 1;
      for (std::size_t k = 0; k < 3; ++k) {
        inside = inside && n.dot((at((k + 1) % 3) - at(k)).cross(p - at(k))) >= 0;
      }
      if (inside && t < best.fraction) {
        best.fraction = t;
        best.body = body;
        best.face = static_cast<int>(f);
        best.position = p;
      }
    }
  }
  if (best.body == nullptr) return std::nullopt;
  return best;
}

double noise() {
  static std::uint64_t state = 7;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return static_cast<double>(state >> 11) * 0x1p-52 - 1.0;
}

TEST(Pick, MatchesBruteForceInEveryWorld) {
  for (const WorldKind kind : {WorldKind::discrete, WorldKind::multibody, WorldKind::soft_rigid,
                               WorldKind::soft_multibody, WorldKind::deformable}) {
    TestWorld world(kind);
    world.add_floor();
    DeformableSystem system(*world);
    ElasticBody a(model_of(Shape::ball), Vec3(0, 0.305, 0)), b(model_of(Shape::part), Vec3(0.7, 0.6, 0.1));
    system.add(a);
    system.add(b);
    world.step(20);
    int hits = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec3 from = 2.0 * Vec3(noise(), noise(), noise()),
                 to = Vec3(0.4, 0.4, 0) + 0.5 * Vec3(noise(), noise(), noise());
      const auto expected = brute_pick(system.bodies(), from, to);
      const auto hit = system.pick(from, to);
      ASSERT_EQ(hit.has_value(), expected.has_value()) << "ray " << i;
      if (hit) {
        ++hits;
        EXPECT_EQ(hit->body, expected->body);
        EXPECT_NEAR(hit->fraction, expected->fraction, by_precision(1e-9, 1e-5));
        EXPECT_LT((hit->position - expected->position).norm(), by_precision(1e-9, 1e-5));
        EXPECT_NEAR(hit->weights.sum(), 1.0, by_precision(1e-9, 1e-4));
        EXPECT_LT((point_at(*hit->body, hit->face, hit->weights) - hit->position).norm(),
                  by_precision(1e-9, 1e-5));
        const Triangle& t = hit->body->faces()[static_cast<std::size_t>(hit->face)];
        EXPECT_TRUE(hit->point == t[0] || hit->point == t[1] || hit->point == t[2]);
      }
    }
    EXPECT_GT(hits, 100);
  }
}

TEST(Pick, SmallBodiesAndShortRays) {
  elastic::ElasticSettings settings;
  settings.cache.folder = "";
  const auto model = elastic::make_elastic_model(sphere(0.01, 2), {1e5, 0.3, 1000}, settings);
  TestWorld world;
  DeformableSystem system(*world);
  ElasticBody body(model, Vec3(0.3, 0.2, 0.1));
  system.add(body);
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 middle(0.3, 0.2, 0.1), outward = Vec3(noise(), noise(), noise()).normalized();
    hits += system.pick(middle + 0.012 * outward, middle).has_value();
  }
  EXPECT_EQ(hits, 200);
}

TEST(Pick, MissesAndDegenerateRays) {
  TestWorld world;
  DeformableSystem system(*world);
  EXPECT_FALSE(system.pick(Vec3(0, 5, 0), Vec3(0, -5, 0)));
  ElasticBody body(model_of(Shape::ball), Vec3::Zero());
  system.add(body);
  EXPECT_TRUE(system.pick(Vec3(0.01, 5, 0.02), Vec3(0.01, -5, 0.02)));
  EXPECT_FALSE(system.pick(Vec3(0.01, 5, 0.02), Vec3(0.01, 2, 0.02)));
  EXPECT_FALSE(system.pick(Vec3(3, 5, 0), Vec3(3, -5, 0)));
  EXPECT_FALSE(system.pick(Vec3(3, 5, 0), Vec3(3, 5, 0)));
}

TEST(Mirror, FollowsTheBody) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::part), Vec3(0, 0.5, 0));
  system.add(body);
  const btSoftBody& mirror = body;
  for (int i = 0; i < 60; ++i) {
    world.step();
    ASSERT_EQ(mirror.m_nodes.size(), static_cast<int>(body.points().size()));
    ASSERT_EQ(mirror.m_faces.size(), static_cast<int>(body.faces().size()));
    for (int v = 0; v < mirror.m_nodes.size(); ++v) {
      const Vec3& p = body.points()[static_cast<std::size_t>(v)];
      ASSERT_EQ(to_bt(p), mirror.m_nodes[v].m_x);
      ASSERT_EQ(to_bt(body.velocities()[static_cast<std::size_t>(v)]), mirror.m_nodes[v].m_v);
      btVector3 low, high;
      mirror.getAabb(low, high);
      for (int k = 0; k < 3; ++k) {
        ASSERT_LE(low[k], btScalar(p[k]));
        ASSERT_GE(high[k], btScalar(p[k]));
      }
      EXPECT_NEAR(mirror.m_nodes[v].m_n.length(), 1.0, 1e-5);
    }
    for (int f = 0; f < mirror.m_faces.size(); ++f) {
      const auto& face = mirror.m_faces[f];
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_EQ(face.m_n[k], &mirror.m_nodes[body.faces()[static_cast<std::size_t>(f)][k]]);
      }
      EXPECT_NEAR(face.m_normal.length(), 1.0, 1e-5);
    }
  }
}

TEST(Mirror, NormalsThatNobodyReadsAreNotComputed) {
  TestWorld world;
  DeformableSystem system(*world);
  ElasticBody drawn(model_of(Shape::part), Vec3(0, 0.5, 0)), hidden(model_of(Shape::part), Vec3(3, 0.5, 0));
  for (ElasticBody* body : {&drawn, &hidden}) {
    body->set_velocity(Vec3::Zero(), Vec3(0, 0, 3));
    system.add(*body);
  }
  hidden.set_mirrored_normals(false);
  const auto turn = [](const ElasticBody& a, const ElasticBody& b) {
    double most = 0;
    for (int v = 0; v < a.m_nodes.size(); ++v) {
      most = std::max(most, double((a.m_nodes[v].m_n - b.m_nodes[v].m_n).length()));
    }
    for (int f = 0; f < a.m_faces.size(); ++f) {
      most = std::max(most, double((a.m_faces[f].m_normal - b.m_faces[f].m_normal).length()));
    }
    return most;
  };
  EXPECT_LT(turn(drawn, hidden), 1e-5);
  world.step(20);
  EXPECT_EQ(system.profile().counts.normals, 1);
  EXPECT_GT(turn(drawn, hidden), 0.5);  // turned by 1 rad since
  hidden.set_mirrored_normals(true);
  EXPECT_LT(turn(drawn, hidden), 1e-5);
  world.step();
  EXPECT_EQ(system.profile().counts.normals, 2);
  EXPECT_LT(turn(drawn, hidden), 1e-5);
}

TEST(Mirror, StockRayTestFindsItInSoftWorlds) {
  for (const WorldKind kind : {WorldKind::soft_rigid, WorldKind::soft_multibody, WorldKind::deformable}) {
    TestWorld world(kind);
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::ball), Vec3(0, 1, 0));
    system.add(body);
    world.step(10);
    const btVector3 from(btScalar(0.03), 3, btScalar(0.02)), to(btScalar(0.03), -1, btScalar(0.02));
    btCollisionWorld::ClosestRayResultCallback result(from, to);
    world->rayTest(from, to, result);
    ASSERT_TRUE(result.hasHit());
    EXPECT_EQ(result.m_collisionObject, &body);
    const auto hit = system.pick(to_vec(from), to_vec(to));
    ASSERT_TRUE(hit);
    EXPECT_NEAR(result.m_closestHitFraction, hit->fraction, 1e-5);
  }
}

TEST(Serialization, OfTheWorldRuns) {
  for (const WorldKind kind : {WorldKind::discrete, WorldKind::multibody, WorldKind::soft_rigid,
                               WorldKind::soft_multibody, WorldKind::deformable}) {
    TestWorld world(kind);
    world.add_floor();
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube), Vec3(0, 0.25, 0));
    system.add(body);
    world.add_box(Vec3(0.1, 0.1, 0.1), 1, Vec3(0, 0.6, 0));
    world.step(30);
    btDefaultSerializer serializer;
    world->serialize(&serializer);
    EXPECT_GT(serializer.getCurrentBufferSize(), 0);
    world.step(5);
  }
}

struct CountingDrawer final : btIDebugDraw {
  int lines = 0, points = 0, mode = 0;
  void drawLine(const btVector3&, const btVector3&, const btVector3&) override { ++lines; }
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int, const btVector3&) override {
    ++points;
  }
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int m) override { mode = m; }
  int getDebugMode() const override { return mode; }
};

TEST(DebugDraw, RunsInEveryWorldAndMode) {
  for (const WorldKind kind : {WorldKind::discrete, WorldKind::multibody, WorldKind::soft_rigid,
                               WorldKind::soft_multibody, WorldKind::deformable}) {
    CountingDrawer drawer;
    TestWorld world(kind);
    world.add_box(Vec3(1, 0.5, 1), 0, Vec3(0, -0.5, 0));
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube), Vec3(0, 0.25, 0));
    system.add(body);
    world.step(30);
    world->setDebugDrawer(&drawer);
    for (const int mode : {int(btIDebugDraw::DBG_DrawWireframe), int(btIDebugDraw::DBG_DrawAabb),
                           int(btIDebugDraw::DBG_DrawNormals), int(btIDebugDraw::DBG_DrawContactPoints),
                           int(btIDebugDraw::DBG_MAX_DEBUG_DRAW_MODE), 0xFFFF}) {
      drawer.mode = mode;
      world->debugDrawWorld();
    }
    EXPECT_GT(drawer.points, 0);
    EXPECT_GT(drawer.lines, 0);
    world->setDebugDrawer(nullptr);
  }
}

TEST(Queries, ContactAndSweepTestsOfBulletMeetItUnharmed) {
  TestWorld world(WorldKind::soft_rigid);
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube), Vec3(0, 0.25, 0));
  system.add(body);
  btRigidBody& box = world.add_box(Vec3(0.1, 0.1, 0.1), 1, Vec3(0, 0.5, 0));
  world.step(30);
  struct Result final : btCollisionWorld::ContactResultCallback {
    btScalar addSingleResult(btManifoldPoint&, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
      return 0;
    }
  } result;
  world->contactTest(&box, result);
  world->contactTest(&body, result);
  world->contactPairTest(&box, &body, result);
  const btSphereShape ball(btScalar(0.1));
  btTransform from, to;
  from.setIdentity();
  to.setIdentity();
  from.setOrigin(btVector3(0, 3, 0));
  btCollisionWorld::ClosestConvexResultCallback sweep(from.getOrigin(), to.getOrigin());
  world->convexSweepTest(&ball, from, to, sweep);
  world.step(30);
  EXPECT_EQ(system.profile().totals.late_substeps, 0);
}

}  // namespace
}  // namespace softpoint

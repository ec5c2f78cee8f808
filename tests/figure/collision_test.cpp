#include <gtest/gtest.h>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/narrowphase/distance.h>

#include "capsule_distance.h"
#include "softpoint/core/error.h"
#include "softpoint/core/shapes.h"
#include "softpoint/figure/figure_collision.h"
#include "support.h"

namespace softpoint::figure {
namespace {

// One free capsule along z.
FigureModel one_body() {
  Link link;
  link.name = "body";
  link.joint = JointKind::kFree;
  link.mass = 1;
  link.inertia = Mat3::Identity();
  return FigureModel({link});
}

struct Segment {
  Vec3 a, b;
};

fcl::Transform3d along(const Segment& s) {
  fcl::Transform3d at = fcl::Transform3d::Identity();
  at.linear() = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), s.b - s.a).toRotationMatrix();
  at.translation() = 0.5 * (s.a + s.b);
  return at;
}

double sampled(const Segment& s, const std::function<double(const Vec3&)>& distance) {
  double best = 1e300;
  for (int k = 0; k <= 2000; ++k) best = std::min(best, distance(s.a + k / 2000.0 * (s.b - s.a)));
  return best;
}

TEST(CapsuleDistance, OfSegmentsIsThatOfFclAndOfDenseSamples) {
  RandomFigures random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    Segment s{random.vector(), random.vector()}, t{random.vector() + Vec3(1, 0, 0), random.vector()};
    if (trial % 5 == 0) t.b = t.a + (0.3 + 0.1 * trial) / 100 * (s.b - s.a);  // parallel
    if (trial % 7 == 0) t.b = t.a;
    const SegmentDistance d = segment_to_segment(s.a, s.b, t.a, t.b);
    const Segment single{s.a + d.at * (s.b - s.a), s.a + d.at * (s.b - s.a)};
    EXPECT_NEAR(segment_to_segment(single.a, single.b, t.a, t.b).distance, d.distance, 1e-12);
    EXPECT_NEAR(d.normal.norm(), 1, 1e-12);
    const double dense =
        sampled(s, [&](const Vec3& x) { return segment_to_segment(x, x, t.a, t.b).distance; });
    EXPECT_LE(d.distance, dense + 1e-12);
    EXPECT_NEAR(d.distance, dense, 4e-3);
    if (trial % 7 == 0 || d.distance < 0.05) continue;
    const fcl::Capsuled one(0.02, (s.b - s.a).norm()), other(0.01, (t.b - t.a).norm());
    fcl::DistanceRequestd request;
    fcl::DistanceResultd result;
    EXPECT_NEAR(fcl::distance(&one, along(s), &other, along(t), request, result), d.distance - 0.03, 1e-9);
  }
}

TEST(CapsuleDistance, OfSegmentAndBoxIsThatOfFclAndOfDenseSamples) {
  RandomFigures random(2);
  int inside = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3 half = 0.2 * Vec3::Ones() + random.vector().cwiseAbs();
    const double spread = trial % 3 == 0 ? 0.6 : 2;
    Segment s{spread * random.vector(), spread * random.vector()};
    if (trial % 5 == 0) s.b = s.a + 0.7 * Vec3::UnitX();
    const SegmentDistance d = segment_to_box(s.a, s.b, half);
    const auto point = [&](const Vec3& x) { return (x - x.cwiseMin(half).cwiseMax(-half)).norm(); };
    EXPECT_NEAR(d.normal.norm(), 1, 1e-12);
    if (d.distance > 0) {
      const double dense = sampled(s, point);
      EXPECT_LE(d.distance, dense + 1e-12);
      EXPECT_NEAR(d.distance, dense, 5e-3);
      if (d.distance < 0.05) continue;
      const fcl::Capsuled one(0.02, (s.b - s.a).norm());
      const fcl::Boxd box(2 * half);
      fcl::DistanceRequestd request;
      fcl::DistanceResultd result;
      const double theirs =
          fcl::distance(&one, along(s), &box, fcl::Transform3d::Identity(), request, result);
      EXPECT_NEAR(theirs, d.distance - 0.02, 2e-4);  // theirs is the coarser one
      continue;
    }
    // Inside: the shift just frees it, and no shorter one does.
    ++inside;
    const auto shifted = [&](const Vec3& by) { return segment_to_box(s.a + by, s.b + by, half).distance; };
    EXPECT_GT(shifted((1e-9 - d.distance) * d.normal), 0);
    for (int k = 0; k < 40; ++k)
      EXPECT_LE(shifted(-0.999 * d.distance * random.vector().normalized()), 1e-12);
  }
  EXPECT_GT(inside, 100);
}

TEST(FigureCollision, TestsExactlyThePairsWhoseBoxesOverlap) {
  RandomFigures random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const FigureModel model = random.model(12, true);
    std::vector<LinkCapsule> capsules;
    for (int i = 0; i < model.link_count(); ++i) {
      capsules.push_back(
          {i, 0.3 * random.vector(), 0.3 * random.vector(), 0.05 + 0.1 * std::abs(random.vector().x())});
    }
    std::vector<Obstacle> obstacles = {half_space({0, 0, -0.5}, random.vector())};
    for (int k = 0; k < 60; ++k) {
      Obstacle o;
      o.kind = k % 2 == 0 ? Obstacle::Kind::kBox : Obstacle::Kind::kCapsule;
      o.position = 1.5 * random.vector();
      o.orientation = random.turn();
      o.size = Vec3::Constant(0.1) + 0.3 * random.vector().cwiseAbs();
      o.radius = 0.1;
      o.length = 0.4;
      obstacles.push_back(o);
    }
    FigureCollision collision(model, capsules, obstacles, {{1, 5}, {2, 9}});
    FigureDynamics dynamics(model);
    const double reach = 0.02;
    for (int pose = 0; pose < 5; ++pose) {
      const FigureState state = random.state(model);
      dynamics.place(state.q.data(), state.qd.data());
      collision.place(dynamics);
      const FigureCollision::Counts before = collision.counts();
      const auto touches = collision.near(reach);
      const FigureCollision::Counts after = collision.counts();
      EXPECT_EQ(after.narrow - before.narrow, after.overlapping - before.overlapping);
      // The same by looking at all of them.
      long long overlapping = 0;
      std::vector<std::pair<int, int>> close;
      for (int i = 0; i < model.link_count(); ++i) {
        const LinkCapsule& c = capsules[static_cast<std::size_t>(i)];
        const LinkMotion m = dynamics.motion(i);
        const Vec3 a = m.position + m.orientation * c.from, b = m.position + m.orientation * c.to;
        const Vec3 around = Vec3::Constant(c.radius + reach);
        const Vec3 low = a.cwiseMin(b) - around, high = a.cwiseMax(b) + around;
        for (std::size_t k = 0; k < obstacles.size(); ++k) {
          const Obstacle& o = obstacles[k];
          double distance = 0;
          bool boxes = false;
          if (o.kind == Obstacle::Kind::kHalfSpace) {
            const Vec3 n = o.orientation.col(2);
            distance = std::min(n.dot(a - o.position), n.dot(b - o.position));
            boxes = n.dot(0.5 * (low + high) - o.position) <= n.cwiseAbs().dot(0.5 * (high - low));
          } else {
            const bool box = o.kind == Obstacle::Kind::kBox;
            const Vec3 arm = 0.5 * o.length * o.orientation.col(2);
            const Vec3 half = box ? Vec3(0.5 * o.orientation.cwiseAbs() * o.size)
                                  : Vec3(arm.cwiseAbs() + Vec3::Constant(o.radius));
            boxes = ((o.position - half).array() <= high.array()).all() &&
                    ((o.position + half).array() >= low.array()).all();
            const Mat3 turn = o.orientation.transpose();
            distance =
                box ? segment_to_box(turn * (a - o.position), turn * (b - o.position), 0.5 * o.size).distance
                    : segment_to_segment(a, b, o.position - arm, o.position + arm).distance - o.radius;
          }
          overlapping += boxes;
          if (distance - c.radius <= reach) close.emplace_back(i, static_cast<int>(k));
        }
      }
      std::vector<std::pair<int, int>> found;
      long long pairs = 0;
      for (const Touch& t : touches) {
        if (t.obstacle < 0) continue;
        if (found.empty() || found.back() != std::pair(t.capsule, t.obstacle))
          found.emplace_back(t.capsule, t.obstacle);
      }
      pairs = after.overlapping - before.overlapping - overlapping;  // those of links
      EXPECT_GE(pairs, 0);
      EXPECT_LE(pairs, 2);
      EXPECT_EQ(found, close);
    }
  }
}

TEST(FigureCollision, LiesOnAPlaneAndOnABoxAtBothEnds) {
  const FigureModel model = one_body();
  Obstacle box;
  box.kind = Obstacle::Kind::kBox;
  box.size = {4, 4, 1};
  box.position = {0, 0, -0.5};
  for (const Obstacle& floor : {half_space({0, 0, 0}, Vec3::UnitZ()), box}) {
    FigureCollision collision(model, {{0, {-0.4, 0, 0}, {0.4, 0, 0}, 0.1}}, {floor});
    FigureDynamics dynamics(model);
    FigureState state = rest_state(model);
    state.q[2] = 0.1 + 1e-4;
    dynamics.place(state.q.data(), state.qd.data());
    collision.place(dynamics);
    const auto touches = collision.near(1e-3);
    ASSERT_EQ(touches.size(), 2u);
    for (const Touch& t : touches) {
      EXPECT_NEAR(t.gap, 1e-4, 1e-12);
      EXPECT_NEAR(std::abs(t.point.x()), 0.4, 1e-12);
      EXPECT_LT((t.normal - Vec3::UnitZ()).norm(), 1e-12);
    }
  }
}

TEST(FigureCollision, MeshesAreAsFarAsTheirTriangles) {
  RandomFigures random(5);
  const FigureModel model = one_body();
  Obstacle mesh;
  mesh.kind = Obstacle::Kind::kMesh;
  mesh.mesh = box_grid(3, 3, 3, {1, 1, 1});
  mesh.position = {0.3, -0.2, 0.1};
  mesh.orientation = random.turn();
  int met = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 a = random.vector(), b = random.vector();
    const auto local = [&](const Vec3& x) {
      return Vec3(mesh.orientation.transpose() * (x - mesh.position));
    };
    const double distance = segment_to_box(local(a), local(b), Vec3::Constant(0.5)).distance;
    if (distance < 0.01) continue;
    FigureCollision collision(model, {{0, a, b, 0.05}}, {mesh});
    FigureDynamics dynamics(model);
    const FigureState state = rest_state(model);
    dynamics.place(state.q.data(), state.qd.data());
    collision.place(dynamics);
    const double gap = distance - 0.05;
    const auto touches = collision.near(0.5);
    if (gap > 0.499) continue;
    ++met;
    ASSERT_EQ(touches.size(), 1u);
    EXPECT_NEAR(touches[0].gap, gap, 1e-10);
  }
  EXPECT_GT(met, 50);
}

TEST(FigureCollision, RefusesWhatIsOutOfRange) {
  const FigureModel model = one_body();
  EXPECT_THROW(FigureCollision(model, {{1, {0, 0, 0}, {0, 0, 1}, 0.1}}, {}), Error);
  EXPECT_THROW(FigureCollision(model, {{0, {0, 0, 0}, {0, 0, 1}, 0}}, {}), Error);
  EXPECT_THROW(FigureCollision(model, {{0, {0, 0, NAN}, {0, 0, 1}, 0.1}}, {}), Error);
  EXPECT_THROW(FigureCollision(model, {}, {}, {{0, 1}}), Error);
  EXPECT_THROW(half_space({0, 0, 0}, {0, 0, 0}), Error);
  Obstacle o;
  o.orientation *= 2;
  EXPECT_THROW(FigureCollision(model, {}, {o}), Error);
}

}  // namespace
}  // namespace softpoint::figure

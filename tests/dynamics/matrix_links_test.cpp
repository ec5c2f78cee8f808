// The row of the matrix for links of multibodies, in every world that steps them: dropped on, dropped, rolled
// on, rolling, sliding on and sliding, momentum, to the bars of the other rows.
#include <gtest/gtest.h>

#include <cmath>

#include "support/matrix_scene.h"
#include "support/matrix_slope.h"
#include "support/matrix_watch.h"
#include "support/multibodies.h"

namespace softpoint {
namespace {

using Joint = ChainSettings::Joint;

struct LinksScene : MatrixScene {
  explicit LinksScene(WorldKind kind) : MatrixScene(kind), multibodies(world) {}
  ~LinksScene() { system.reset(); }

  btMultiBody& add(const ChainSettings& settings) {
    chain = &multibodies.add_chain(settings);
    return *chain;
  }
  // A floor whose top is at y = 0, of eight boxes side by side.
  void put_row(double friction = 0.5) {
    add({.links = 7,
         .base = Vec3(-0.875, -0.2, 0),
         .half = Vec3(0.125, 0.2, 0.6),
         .joint = Joint::fixed,
         .gap = 0});
    set_friction(friction);
  }
  void set_friction(double friction) {
    for (int link = -1; link < chain->getNumLinks(); ++link) object(link).setFriction(btScalar(friction));
  }
  // Turned about the middle of a straight row of equal parts, whose middle comes to `middle`.
  void place(const Vec3& middle, const btQuaternion& turned, double pitch) {
    const Vec3 ahead = to_vec(quatRotate(turned, btVector3(1, 0, 0)));
    chain->setBaseWorldTransform(
        btTransform(turned, to_bt(middle - 0.5 * chain->getNumLinks() * pitch * ahead)));
    Multibodies::place(*chain);
  }
  btMultiBodyLinkCollider& object(int link) const {
    return link < 0 ? *chain->getBaseCollider() : *chain->getLinkCollider(link);
  }
  double link_depth(const Surface& skin) const {
    double deepest = -1;
    for (int link = -1; link < chain->getNumLinks(); ++link) {
      deepest = std::max({deepest, skin_depth(skin, object(link)), corner_depth(skin, object(link))});
    }
    return deepest;
  }
  // The body rests `gap` (m) above the links.
  std::unique_ptr<ElasticBody> above_links(Shape shape, double young, const Vec3& beside, double gap,
                                           const Mat3& rotation, double density = 1000.0) {
    auto body = place_above([&](const ElasticBody& b) { return link_depth(b); }, shape, young, beside, gap,
                            rotation, density);
    system->add(*body);
    return body;
  }

  Multibodies multibodies;
  btMultiBody* chain = nullptr;
};

class MatrixLinks : public ::testing::TestWithParam<WorldKind> {
 protected:
  std::string name(const char* what) const { return std::string(name_of(GetParam())) + what; }
};

btQuaternion turn_of(const Fall& fall) {
  return btQuaternion(to_bt(fall.axis.normalized()), btScalar(fall.angle));
}

void drop_on(LinksScene& scene, const Fall& fall, double density, const std::string& name) {
  const auto body =
      scene.above_links(Shape::part, kSoft, fall.beside, 0.02,
                        Eigen::AngleAxisd(fall.angle, fall.axis.normalized()).toRotationMatrix(), density);
  body->set_velocity(Vec3(0, -fall.speed, 0), Vec3(0.5, 0.2, -0.3));
  Watch watch;
  for (int i = 0; i < 45; ++i) {
    scene.world.step();
    watch.see(scene.link_depth(*body), i, *scene.system);
  }
  watch.judge(name, *scene.system);
}

TEST_P(MatrixLinks, BodyDroppedOnARowStaysOutside) {
  for (const Fall& fall : falls()) {
    LinksScene scene(GetParam());
    scene.add(
        {.links = 2, .base = Vec3(-0.22, -0.15, 0), .half = Vec3(0.1, 0.15, 0.2), .joint = Joint::fixed});
    drop_on(scene, fall, 1000, name("DropOnRow"));
  }
}

// Planks on hinges, free to rise and to turn, on a floor that the body does not reach.
TEST_P(MatrixLinks, BodyDroppedOnHingedPlanksStaysOutside) {
  for (const Fall& fall : falls()) {
    LinksScene scene(GetParam());
    scene.world.add_floor(-0.2);
    scene.add({.links = 2,
               .fixed_base = false,
               .base = Vec3(-0.42, -0.1, 0),
               .half = Vec3(0.2, 0.1, 0.4),
               .mass = 30});
    drop_on(scene, fall, 200, name("DropOnPlanks"));
  }
}

TEST_P(MatrixLinks, DroppedChainStaysOutside) {
  for (const Joint joint : {Joint::hinge, Joint::ball, Joint::slider}) {
    for (const Fall& fall : falls()) {
      LinksScene scene(GetParam());
      scene.put_slab(kSoft);
      const ChainSettings settings{
          .links = 2, .fixed_base = false, .half = Vec3(0.06, 0.04, 0.06), .mass = 0.7, .joint = joint};
      scene.add(settings);
      double height = 0.6;
      do {
        height -= 0.005;
        scene.place(fall.beside + Vec3(0, height, 0), turn_of(fall), 0.14);
      } while (-scene.link_depth(*scene.slab) > 0.02);
      scene.chain->setBaseVel(btVector3(0, btScalar(-fall.speed), 0));
      scene.chain->setBaseOmega(to_bt(Vec3(0.5, 0.2, -0.3)));
      Watch watch;
      for (int i = 0; i < 45; ++i) {
        scene.world.step();
        watch.see(scene.link_depth(*scene.slab), i, *scene.system);
      }
      watch.judge(name(joint == Joint::hinge  ? "DropOfHinged"
                       : joint == Joint::ball ? "DropOfBallJointed"
                                              : "DropOfSliding"),
                  *scene.system);
    }
  }
}

TEST_P(MatrixLinks, BallRollsSmoothlyOverARow) {
  LinksScene scene(GetParam());
  scene.put_row();
  const double speed = 0.8, radius = 0.12;
  const Vec3 from(-0.4, 0, 0.01);
  const auto ball = scene.above_links(Shape::marble, 3e5, from, 1.01e-3, Mat3::Identity());
  ball->set_velocity(Vec3(speed, 0, 0), Vec3(0, 0, -speed / radius));
  Watch watch;
  Track track;
  for (int i = 0; i < 60; ++i) {
    scene.world.step();
    watch.see(scene.link_depth(*ball), i, *scene.system);
    track.heights.push_back(ball->center_of_mass().y());
  }
  watch.judge(name("RollOn"), *scene.system);
  const double way = ball->center_of_mass().x() - from.x();
  track.judge(name("RollOn"), way);
  EXPECT_GT(way, 0.5 * speed);
}

// Two balls on one axle, on which each turns by itself.
TEST_P(MatrixLinks, WheelsRollSmoothly) {
  LinksScene scene(GetParam());
  scene.put_slab(1e6);
  const double speed = 0.4, radius = 0.09;
  scene.add({.links = 1,
             .fixed_base = false,
             .half = Vec3(radius, radius, radius),
             .balls = true,
             .mass = 1,
             .axis = Vec3::UnitX(),
             .gap = 0.01});
  const Vec3 from(-0.25, radius + 1.01e-3, 0.01);
  scene.place(from, btQuaternion(btVector3(0, 1, 0), -SIMD_HALF_PI), 2 * radius + 0.01);
  scene.chain->setBaseVel(btVector3(btScalar(speed), 0, 0));
  scene.chain->setBaseOmega(btVector3(0, 0, btScalar(-speed / radius)));
  Watch watch;
  Track track;
  for (int i = 0; i < 60; ++i) {
    scene.world.step();
    watch.see(scene.link_depth(*scene.slab), i, *scene.system);
    track.heights.push_back(scene.object(0).getWorldTransform().getOrigin().y());
  }
  watch.judge(name("RollOf"), *scene.system);
  const double way = scene.object(0).getWorldTransform().getOrigin().x() - from.x();
  track.judge(name("RollOf"), way);
  EXPECT_GT(way, 0.5 * speed);
}

TEST_P(MatrixLinks, BlockSlidesOnARowFromTheAngleOfFriction) {
  judge_slope(name("SlideOn"), [](double angle) {
    LinksScene scene(GetParam());
    scene.put_row(1.0);
    const auto block = scene.above_links(Shape::block, kStiff, Vec3(-0.2, 0, 0.01), 1e-3, Mat3::Identity());
    block->setFriction(kFriction);
    scene.tilt(angle);
    return measure(
        scene.world, [&] { return block->center_of_mass().x(); },
        [&] { return block->momentum().x() / block->total_mass(); });
  });
}

TEST_P(MatrixLinks, HingedChainSlidesFromTheAngleOfFriction) {
  judge_slope(name("SlideOf"), [](double angle) {
    LinksScene scene(GetParam());
    scene.put_slab(kStiff);
    scene.slab->setFriction(kFriction);
    scene.add({.links = 2, .fixed_base = false, .half = Vec3(0.06, 0.03, 0.06), .mass = 0.7});
    scene.place(Vec3(-0.2, 0.03 + 1e-3, 0.01), btQuaternion::getIdentity(), 0.14);
    scene.set_friction(1.0);
    scene.tilt(angle);
    return measure(
        scene.world, [&] { return double(scene.object(0).getWorldTransform().getOrigin().x()); },
        [&] { return double(scene.chain->getBaseVel().x()); });
  });
}

// Change of the momentum that a body and a chain have together, of sum |m v| and of sum |r| |m v| (m,
// origin).
struct Change {
  double linear = 0, angular = 0;
  int touched = 0;
  void judge(const std::string& name) const {
    std::printf("    %-24s linear %.1e, angular %.1e, %d steps in contact\n", name.c_str(), linear, angular,
                touched);
    EXPECT_GT(touched, 0);
    EXPECT_LE(linear, kMomentum);
    EXPECT_LE(angular, kMomentum);
  }
};

// A step of the chain is measured against a twin that is alone, in the pose the step began with, since
// Bullet's own step keeps the momentum of a moving chain only to first order. Stops with the first touch
// where `first` says so.
Change exchange(WorldKind kind, const ChainSettings& settings, bool first) {
  LinksScene scene(kind);
  TestWorld twin_world(kind);
  Multibodies twins(twin_world);
  for (TestWorld* w : {&scene.world, &twin_world}) (*w)->setGravity(btVector3(0, 0, 0));
  ElasticBody ball(model_of(Shape::marble, kSoft), Vec3(0.1, 0.05, -0.1));
  ball.set_velocity(Vec3(0.3, 0, 0.1), Vec3(0, 2, 1));
  scene.system->add(ball);
  scene.add(settings);
  btMultiBody& twin = twins.add_chain(settings);
  scene.place(Vec3(0.13, 0.32, -0.08),
              btQuaternion(btVector3(1, 0, btScalar(0.3)).normalized(), btScalar(0.5)),
              2 * settings.half.x() + settings.gap);
  scene.chain->setBaseVel(btVector3(0, -2, 0));
  scene.chain->setBaseOmega(btVector3(3, -1, 2));
  Change change;
  for (int i = 0; i < 60 && !(first && change.touched > 0); ++i) {
    const MultibodyState before = MultibodyState::of(*scene.chain);
    before.put_positions(twin);
    before.put_velocities(twin);
    const Vec3 p_before = ball.momentum(), l_before = ball.angular_momentum();
    twin_world.step();
    scene.world.step();
    if (scene.system->contacts().empty()) continue;
    ++change.touched;
    const MultibodyState alone = MultibodyState::of(twin);
    before.put_positions(twin);
    alone.put_velocities(twin);
    const MultibodyMomentum without = MultibodyMomentum::of(twin);
    MultibodyState::of(*scene.chain).put_velocities(twin);
    const MultibodyMomentum with = MultibodyMomentum::of(twin);
    double linear_scale = with.linear.norm(), angular_scale = with.angular.norm();
    for (std::size_t v = 0; v < ball.points().size(); ++v) {
      const double p = ball.masses()[v] * ball.velocities()[v].norm();
      linear_scale += p;
      angular_scale += ball.points()[v].norm() * p;
    }
    const Vec3 p = ball.momentum() - p_before + with.linear - without.linear;
    const Vec3 l = ball.angular_momentum() - l_before + with.angular - without.angular;
    change.linear = std::max(change.linear, p.norm() / linear_scale);
    change.angular = std::max(change.angular, l.norm() / angular_scale);
  }
  return change;
}

TEST_P(MatrixLinks, MomentumIsKeptInEveryStep) {
  ChainSettings base{.links = 0, .fixed_base = false, .half = Vec3(0.09, 0.09, 0.09), .mass = 5};
  exchange(GetParam(), base, false).judge(name("MomentumOfABox"));
  ChainSettings chain{.links = 2, .fixed_base = false, .half = Vec3(0.06, 0.05, 0.06), .mass = 1.7};
  chain.axis = Vec3(0.3, 0.2, 1).normalized();
  exchange(GetParam(), chain, true).judge(name("MomentumOfHinged"));
  chain.joint = Joint::ball;
  exchange(GetParam(), chain, true).judge(name("MomentumOfBallJointed"));
}

std::string world_name(const ::testing::TestParamInfo<WorldKind>& info) { return name_of(info.param); }

INSTANTIATE_TEST_SUITE_P(Worlds, MatrixLinks,
                         ::testing::Values(WorldKind::multibody, WorldKind::soft_multibody,
                                           WorldKind::deformable),
                         world_name);

}  // namespace
}  // namespace softpoint

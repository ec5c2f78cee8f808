#include "softpoint/figure/articulated_controller.h"

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>

#include <Eigen/Geometry>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

btVector3 bullet(const Vec3& x) {
  return {static_cast<btScalar>(x.x()), static_cast<btScalar>(x.y()), static_cast<btScalar>(x.z())};
}

btTransform bullet(const Vec3& place, const Mat3& axes) {
  const Eigen::Quaterniond q(axes);
  return btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                  static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w()))
                         .normalized(),
                     bullet(place));
}

}  // namespace

struct __attribute__((visibility("hidden"))) ArticulatedController::Impl {
  Impl(btDiscreteDynamicsWorld& in, const FigureAnimation& what)
      : world(in), animation(what), placer(what.model()) {}

  void publish();

  struct Body {
    LinkCapsule capsule;
    Vec3 middle;  // m, and
    Mat3 turn;    // its axis as z: in the link's frame
    std::unique_ptr<btCollisionShape> shape;
    std::unique_ptr<btRigidBody> body;
  };

  btDiscreteDynamicsWorld& world;
  const FigureAnimation& animation;
  FigureDynamics placer;
  FigureState state;
  std::vector<Body> bodies;
  double time = 0;
};

void ArticulatedController::Impl::publish() {
  animation.sample(time, state);
  placer.place(state.q.data(), state.qd.data());
  int last = -1;
  LinkMotion motion;
  for (Body& b : bodies) {
    if (b.capsule.link != last) motion = placer.motion(last = b.capsule.link);
    const Vec3 arm = motion.orientation * b.middle;
    b.body->setWorldTransform(bullet(motion.position + arm, motion.orientation * b.turn));
    b.body->setLinearVelocity(bullet(motion.velocity + motion.angular_velocity.cross(arm)));
    b.body->setAngularVelocity(bullet(motion.angular_velocity));
  }
}

ArticulatedController::ArticulatedController(btDiscreteDynamicsWorld& world, const FigureAnimation& animation,
                                             int group, int mask)
    : impl_(std::make_unique<Impl>(world, animation)) {
  if (animation.frame_count() == 0) {
    throw Error("animation that was not evaluated; permitted is one after evaluate()");
  }
  const std::vector<LinkCapsule>& capsules = animation.clip().capsules;
  if (capsules.empty()) throw Error("animation of a clip without capsules; permitted is at least one");
  for (const LinkCapsule& c : capsules) {
    Impl::Body b;
    b.capsule = c;
    b.middle = 0.5 * (c.from + c.to);
    const Vec3 along = c.to - c.from;
    b.turn = Mat3::Identity();
    if (along.norm() > 0) {
      b.turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), along).toRotationMatrix();
    }
    b.shape = std::make_unique<btCapsuleShapeZ>(static_cast<btScalar>(c.radius),
                                                static_cast<btScalar>(along.norm()));
    btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, b.shape.get());
    b.body = std::make_unique<btRigidBody>(info);
    b.body->setCollisionFlags(b.body->getCollisionFlags() & ~btCollisionObject::CF_STATIC_OBJECT);
    b.body->setCollisionFlags(b.body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    b.body->setActivationState(DISABLE_DEACTIVATION);
    impl_->bodies.push_back(std::move(b));
  }
  set_time(0);
  for (Impl::Body& b : impl_->bodies) world.addRigidBody(b.body.get(), group, mask);
  world.addAction(this);
}

ArticulatedController::~ArticulatedController() {
  impl_->world.removeAction(this);
  for (Impl::Body& b : impl_->bodies) impl_->world.removeRigidBody(b.body.get());
}

const FigureAnimation& ArticulatedController::animation() const { return impl_->animation; }
const FigureState& ArticulatedController::state() const { return impl_->state; }
double ArticulatedController::time() const { return impl_->time; }
int ArticulatedController::body_count() const { return static_cast<int>(impl_->bodies.size()); }

btRigidBody& ArticulatedController::body(int capsule) {
  check_index("capsule", capsule, body_count());
  return *impl_->bodies[static_cast<std::size_t>(capsule)].body;
}
const btRigidBody& ArticulatedController::body(int capsule) const {
  check_index("capsule", capsule, body_count());
  return *impl_->bodies[static_cast<std::size_t>(capsule)].body;
}

void ArticulatedController::set_time(double time) {
  check_range("time", time, 0, 1e6);
  impl_->time = time;
  impl_->publish();
  // Bullet takes a kinematic body's velocity from where it was seen last.
  for (Impl::Body& b : impl_->bodies) b.body->setInterpolationWorldTransform(b.body->getWorldTransform());
}

void ArticulatedController::updateAction(btCollisionWorld*, btScalar dt) {
  impl_->time += static_cast<double>(dt);
  impl_->publish();
}

void ArticulatedController::debugDraw(btIDebugDraw*) {}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

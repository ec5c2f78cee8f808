#include "softpoint/figure/articulated_controller.h"

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "controller_impl.h"
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

void ArticulatedController::Impl::publish() {
  const FigureState& state = figure.state();
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
                                             int group, int mask, const ControllerSettings& settings)
    : impl_(std::make_unique<Impl>(world, animation, group, mask, settings)) {
  check_range("max_step", settings.max_step, 1e-5, 1);
  check_range("return_time", settings.return_time, 1e-3, 1e3);
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
  impl_->links.assign(impl_->bodies.size(), -1);
  impl_->by.resize(impl_->rates.size());
  for (Impl::Body& b : impl_->bodies) {
    for (btRigidBody* other : impl_->shown) b.body->setIgnoreCollisionCheck(other, true);
    for (btRigidBody* other : impl_->shown) other->setIgnoreCollisionCheck(b.body.get(), true);
    impl_->shown.push_back(b.body.get());
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
const FigureState& ArticulatedController::state() const { return impl_->figure.state(); }
double ArticulatedController::time() const { return impl_->figure.time(); }
bool ArticulatedController::dynamic(int link) const {
  check_index("link", link, animation().model().link_count());
  return impl_->figure.dynamic(link);
}
const ControllerCounts& ArticulatedController::counts() const { return impl_->counts; }
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
  std::fill(impl_->wanted.begin(), impl_->wanted.end(), 0);
  impl_->figure.choose(std::vector<char>(impl_->wanted), impl_->settings.return_time);
  impl_->choose();
  impl_->figure.restart(time);
  impl_->publish();
  // Bullet takes a kinematic body's velocity from where it was seen last.
  for (Impl::Body& b : impl_->bodies) b.body->setInterpolationWorldTransform(b.body->getWorldTransform());
}

void ArticulatedController::set_dynamic(std::span<const bool> links) {
  if (links.size() != impl_->wanted.size()) {
    throw Error("links: " + std::to_string(links.size()) + " flags; permitted are " +
                std::to_string(impl_->wanted.size()) + ", one for each link");
  }
  std::copy(links.begin(), links.end(), impl_->wanted.begin());
  impl_->choose();
}

void ArticulatedController::hand_over(int link, bool dynamic) {
  const std::vector<Link>& links = animation().model().links();
  check_index("link", link, animation().model().link_count());
  std::vector<char> in(links.size(), 0);
  for (std::size_t i = static_cast<std::size_t>(link); i < links.size(); ++i) {
    const int parent = links[i].parent;
    in[i] = static_cast<int>(i) == link || (parent >= 0 && in[static_cast<std::size_t>(parent)]);
    if (in[i]) impl_->wanted[i] = dynamic;
  }
  impl_->choose();
}

void ArticulatedController::updateAction(btCollisionWorld*, btScalar dt) {
  impl_->advance(static_cast<double>(dt));
  impl_->publish();
}

void ArticulatedController::debugDraw(btIDebugDraw*) {}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

#include "metrics_state.h"

#include <Eigen/Geometry>

#include "bullet_border.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

void add_rigid(MechanicalState& state, const RigidActor& actor, const Vec3& gravity) {
  const btRigidBody& body = actor.body();
  const Vec3 velocity = from_bullet(body.getLinearVelocity());
  const Vec3 spin = from_bullet(body.getAngularVelocity());
  const Placement pose = from_bullet(body.getWorldTransform());
  const Vec3 inertia = from_bullet(body.getLocalInertia());
  const Vec3 about_center = pose.rotation * inertia.cwiseProduct(pose.rotation.transpose() * spin);
  const double mass = actor.mass();
  state.kinetic += 0.5 * (mass * velocity.squaredNorm() + spin.dot(about_center));
  state.potential -= mass * gravity.dot(pose.position);
  state.momentum += mass * velocity;
  state.momentum_scale += mass * velocity.norm();
  state.angular_momentum += mass * pose.position.cross(velocity) + about_center;
}

void add_deformable(MechanicalState& state, const Deformable& body, const Vec3& gravity) {
  const Vec3 momentum = body.momentum();
  state.kinetic += body.kinetic_energy();
  state.elastic += body.elastic_energy();
  state.potential -= body.total_mass() * gravity.dot(body.center_of_mass());
  state.momentum += momentum;
  state.momentum_scale += momentum.norm();
  state.angular_momentum += body.angular_momentum();
}

}  // namespace

MechanicalState measure_state(Player& player) {
  MechanicalState state;
  const Vec3 gravity = from_bullet(player.world().getGravity());
  for (std::size_t k = 0; k < player.rigid_count(); ++k) {
    if (player.rigid(k).mass() > 0.0 && player.present({false, static_cast<int>(k)})) {
      add_rigid(state, player.rigid(k), gravity);
    }
  }
  for (std::size_t k = 0; k < player.deformable_count(); ++k) {
    if (player.present({true, static_cast<int>(k)})) {
      add_deformable(state, player.deformable(k), gravity);
    }
  }
  return state;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

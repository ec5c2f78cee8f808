#include "player_rigid.h"

#include <btBulletCollisionCommon.h>

#include <cmath>

#include "bullet_border.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

// Bullet rounds hulls and cones outward by their margin, 4 cm unless told otherwise.
constexpr btScalar kRoundedMargin = 1e-3F;  // m

btScalar scalar(double value) { return static_cast<btScalar>(value); }

Placement operator*(const Placement& a, const Placement& b) {
  return {a.to_world(b.position), a.rotation * b.rotation};
}

Placement inverse(const Placement& a) {
  return {-(a.rotation.transpose() * a.position), a.rotation.transpose()};
}

}  // namespace

btCollisionShape* RigidActor::make_convex(const ShapeSpec& s) {
  const btScalar r = scalar(s.radius), l = scalar(s.length), half = scalar(0.5 * s.length);
  std::unique_ptr<btCollisionShape> shape;
  switch (s.kind) {
    case ShapeKind::kBox:
      shape = std::make_unique<btBoxShape>(to_bullet(0.5 * s.size));
      break;
    case ShapeKind::kSphere:
      shape = std::make_unique<btSphereShape>(r);
      break;
    case ShapeKind::kCapsule:
      shape = s.axis == 0   ? std::make_unique<btCapsuleShapeX>(r, l)
              : s.axis == 1 ? std::make_unique<btCapsuleShape>(r, l)
                            : std::unique_ptr<btCapsuleShape>(std::make_unique<btCapsuleShapeZ>(r, l));
      break;
    case ShapeKind::kCylinder: {
      btVector3 extents(r, r, r);
      extents[s.axis] = half;
      if (s.axis == 0) {
        shape = std::make_unique<btCylinderShapeX>(extents);
      } else if (s.axis == 1) {
        shape = std::make_unique<btCylinderShape>(extents);
      } else {
        shape = std::make_unique<btCylinderShapeZ>(extents);
      }
      break;
    }
    case ShapeKind::kCone: {
      auto cone = std::make_unique<btConeShape>(r, l);
      cone->setConeUpIndex(s.axis);
      cone->setMargin(kRoundedMargin);
      shape = std::move(cone);
      break;
    }
    case ShapeKind::kPlane:
      shape = std::make_unique<btStaticPlaneShape>(to_bullet(s.normal), scalar(s.offset));
      break;
    default: {
      auto hull = std::make_unique<btConvexHullShape>();
      const ConvexSolid solid(s);
      for (const Vec3& corner : solid.corners()) {
        hull->addPoint(to_bullet(corner), false);
      }
      hull->recalcLocalAabb();
      hull->setMargin(kRoundedMargin);
      shape = std::move(hull);
    }
  }
  shapes_.push_back(std::move(shape));
  return shapes_.back().get();
}

btCollisionShape* RigidActor::make_mesh(const ShapeSpec& s) {
  mesh_corners_ = s.points;
  mesh_ = std::make_unique<btTriangleMesh>();
  for (const Triangle& t : s.triangles) {
    const auto corner = [&](std::size_t k) { return to_bullet(s.points[static_cast<std::size_t>(t[k])]); };
    mesh_->addTriangle(corner(0), corner(1), corner(2));
  }
  shapes_.push_back(std::make_unique<btBvhTriangleMeshShape>(mesh_.get(), true));
  shapes_.back()->setMargin(kRoundedMargin);
  return shapes_.back().get();
}

// Mass goes by volume; Bullet's frame is put at the centre of mass, along the principal axes.
btCollisionShape* RigidActor::make_compound(const RigidBodySpec& spec, Placement& body_in_shape,
                                            btVector3& inertia) {
  std::vector<ShapePart> parts = spec.shape.parts;
  if (spec.shape.kind != ShapeKind::kCompound) {
    parts = {{spec.shape, {}}};
  }
  btCompoundShape draft;
  std::vector<btScalar> masses;
  double volume = 0;
  std::vector<ConvexSolid> solids;
  for (const ShapePart& part : parts) {
    solids.emplace_back(part.shape);
    volume += solids.back().volume();
  }
  for (std::size_t k = 0; k < parts.size(); ++k) {
    // Bullet takes a part's centre of mass for the origin of its shape: let the draft's parts agree.
    Placement at_center = parts[k].placement;
    at_center.position = parts[k].placement.to_world(solids[k].center());
    draft.addChildShape(to_bullet(at_center), make_convex(parts[k].shape));
    masses.push_back(scalar((spec.mass > 0.0 ? spec.mass : 1.0) * solids[k].volume() / volume));
  }
  btTransform principal = btTransform::getIdentity();
  draft.calculatePrincipalAxisTransform(masses.data(), principal, inertia);
  body_in_shape = from_bullet(principal);
  auto compound = std::make_unique<btCompoundShape>();
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Placement in_body = inverse(body_in_shape) * parts[k].placement;
    compound->addChildShape(to_bullet(in_body), draft.getChildShape(static_cast<int>(k)));
    solids_.push_back({std::move(solids[k]), in_body});
  }
  shapes_.push_back(std::move(compound));
  return shapes_.back().get();
}

btCollisionShape* RigidActor::make_shape(const RigidBodySpec& spec, Placement& body_in_shape,
                                         btVector3& inertia) {
  if (spec.shape.kind == ShapeKind::kMesh) {
    return make_mesh(spec.shape);
  }
  const bool is_compound = spec.shape.kind == ShapeKind::kCompound;
  if (is_compound || (spec.mass > 0.0 && !ConvexSolid(spec.shape).center().isZero(1e-9))) {
    return make_compound(spec, body_in_shape, inertia);
  }
  btCollisionShape* shape = make_convex(spec.shape);
  if (spec.mass > 0.0) {
    shape->calculateLocalInertia(scalar(spec.mass), inertia);
  }
  solids_.push_back({ConvexSolid(spec.shape), {}});
  return shape;
}

RigidActor::RigidActor(const RigidBodySpec& spec) : mass_(spec.mass) {
  Placement body_in_shape;
  btVector3 inertia(0, 0, 0);
  btCollisionShape* shape = make_shape(spec, body_in_shape, inertia);
  if (mass_ == 0.0) {
    inertia.setZero();
  }
  btRigidBody::btRigidBodyConstructionInfo info(scalar(mass_), nullptr, shape, inertia);
  info.m_startWorldTransform = to_bullet(spec.placement * body_in_shape);
  info.m_friction = scalar(spec.friction);
  info.m_restitution = scalar(spec.restitution);
  info.m_rollingFriction = scalar(spec.rolling_friction);
  info.m_linearDamping = scalar(spec.linear_damping);
  info.m_angularDamping = scalar(spec.angular_damping);
  body_ = std::make_unique<btRigidBody>(info);
  body_->setLinearVelocity(to_bullet(spec.motion.linear));
  body_->setAngularVelocity(to_bullet(spec.motion.angular));
  if (!spec.may_sleep) {
    body_->setActivationState(DISABLE_DEACTIVATION);
  }
}

Placement RigidActor::placement() const { return from_bullet(body_->getWorldTransform()); }

Placement RigidActor::solid_placement(std::size_t k) const {
  return from_bullet(body_->getWorldTransform()) * solids_[k].in_body;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

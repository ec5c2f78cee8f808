#include "near_colliders_impl.h"

#include <Eigen/Geometry>

#include <cmath>

#include "index.h"
#include "nearest_points.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Sweeps over rigid contacts after each part of a step; what is left is for the next one.
constexpr int kSupportSweeps = 8;
constexpr double kSupportTolerance = 1e-9;  // m
// Nearest points whose offset has a lower cosine to the surface's normal lie on its rim.
constexpr double kOnRim = 0.3;

// The nearest point of a mesh, with the side of it the point belongs to.
bool nearest_on_mesh(const ColliderShape& shape, const Vec3& p, double reach, signed char& side,
                     NearSurface& surface) {
  double best = reach * reach;
  Vec3 offset = Vec3::Zero(), normal = Vec3::Zero();
  bool found = false;
  shape.facet_tree.near_point(p, best, [&](int f) {
    const ShapeFacet& facet = shape.facets[at(f)];
    const Vec3 w = nearest_weights(p, facet.a, facet.b, facet.c);
    const Vec3 to_point = p - (w[0] * facet.a + w[1] * facet.b + w[2] * facet.c);
    const double squared = to_point.squaredNorm();
    constexpr double kSame = 1e-15;  // m^2: the same edge or corner seen from another facet
    if (squared > best + kSame) {
      return;
    }
    if (!found || squared < best - kSame) {
      normal.setZero();
    }
    found = true;
    best = std::min(best, squared);
    offset = to_point;
    normal += facet.normal;
  });
  if (!found) {
    side = 0;
    return false;
  }
  const double distance = std::sqrt(best);
  normal.normalize();
  const double height = offset.dot(normal);
  const bool on_rim = std::abs(height) < kOnRim * distance;
  if (side == 0 || (on_rim && distance > 1e-6)) {
    side = height < 0.0 ? -1 : 1;  // past a rim it may have gone round
  }
  const bool behind = height * side < 0.0 && !on_rim;
  surface.gap = behind ? -distance : distance;
  surface.normal = distance > 1e-9 ? Vec3((behind ? -1.0 : 1.0) * offset / distance) : Vec3(side * normal);
  return true;
}

}  // namespace

void NearColliders::Impl::clear(RigidStates& states, SupportContacts& contacts, double dt) {
  rigid = &states;
  support = &contacts;
  step = dt;
  bodies.clear();
  parts.clear();
}

int NearColliders::Impl::body(int index, double friction) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].rigid == index) {
      return static_cast<int>(i);
    }
  }
  const RigidState& state = (*rigid)[index];
  Body added;
  added.seen = {state.object, state.movable(), friction};
  added.rigid = index;
  added.pose = state.start;
  added.first_velocity = state.velocity;
  added.first_spin = state.angular_velocity;
  bodies.push_back(added);
  return static_cast<int>(bodies.size()) - 1;
}

void NearColliders::Impl::add_part(int collider, int child, const ColliderShape& shape, const Pose& local,
                                   std::span<signed char> sides) {
  Part part;
  part.seen = {collider, child, shape.kind == ColliderShape::Kind::plane,
               shape.kind == ColliderShape::Kind::mesh, shape.thinnest};
  part.shape = &shape;
  part.local = local;
  part.sides = sides;
  parts.push_back(part);
}

void NearColliders::Impl::settle(std::vector<LastVelocity>& last) {
  for (Body& body : bodies) {
    RigidState& state = (*rigid)[body.rigid];
    if (state.body == nullptr ||
        (state.velocity == body.first_velocity && state.angular_velocity == body.first_spin)) {
      continue;  // nothing has changed, or a link: it moves by the velocity it has now
    }
    last.push_back({state.body, state.velocity, state.angular_velocity});
    const Eigen::AngleAxisd turn(Mat3(body.pose.rotation * state.start.rotation.transpose()));
    state.velocity = (body.pose.origin - state.start.origin) / step;
    state.angular_velocity = turn.angle() / step * turn.axis();
    state.end = body.pose;
    state.changed = true;
  }
}

NearColliders::NearColliders(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NearColliders::~NearColliders() = default;

int NearColliders::colliders() const { return static_cast<int>(impl_->bodies.size()); }
const NearColliders::Collider& NearColliders::collider(int index) const {
  return impl_->bodies[at(index)].seen;
}
int NearColliders::pieces() const { return static_cast<int>(impl_->parts.size()); }
const NearColliders::Piece& NearColliders::piece(int index) const { return impl_->parts[at(index)].seen; }

Vec3 NearColliders::center(int collider) const { return impl_->bodies[at(collider)].pose.origin; }
Vec3 NearColliders::to_world(int collider, const Vec3& local) const {
  return impl_->bodies[at(collider)].pose.to_world(local);
}
Vec3 NearColliders::to_local(int collider, const Vec3& point) const {
  return impl_->bodies[at(collider)].pose.to_local(point);
}
Vec3 NearColliders::velocity(int collider) const {
  return (*impl_->rigid)[impl_->bodies[at(collider)].rigid].velocity;
}
Vec3 NearColliders::spin(int collider) const {
  return (*impl_->rigid)[impl_->bodies[at(collider)].rigid].angular_velocity;
}
Vec3 NearColliders::velocity_at(int collider, const Vec3& point) const {
  const Impl::Body& body = impl_->bodies[at(collider)];
  return (*impl_->rigid)[body.rigid].velocity_of(point - body.pose.origin);
}

void NearColliders::mobility(int collider, double* block) const {
  impl_->rigid->mobility(impl_->bodies[at(collider)].rigid, block);
}

void NearColliders::push(int collider, const Vec3& impulse, const Vec3& point) {
  push(collider, impulse, point, Vec3::Zero());
}

void NearColliders::push(int collider, const Vec3& impulse, const Vec3& point, const Vec3& moment) {
  Impl::Body& body = impl_->bodies[at(collider)];
  const Vec3 about_center = (point - body.pose.origin).cross(impulse) + moment;
  body.load.impulse += impulse;
  body.load.moment += about_center;
  body.pushed = true;
  impl_->rigid->push_wrench(body.rigid, impulse, about_center);
}

void NearColliders::begin(double dt) {
  for (const Impl::Body& body : impl_->bodies) {
    const double part = -dt / impl_->step;
    impl_->rigid->push_wrench(body.rigid, part * body.carried.impulse, part * body.carried.moment);
  }
}

void NearColliders::advance(double dt) {
  for (int i = 0; i < kSupportSweeps && impl_->support->size() > 0; ++i) {
    if (impl_->support->sweep(*impl_->rigid, dt) < kSupportTolerance) {
      break;
    }
  }
  for (Impl::Body& body : impl_->bodies) {
    const RigidState& state = (*impl_->rigid)[body.rigid];
    body.pose.origin += dt * state.velocity;
    body.pose.rotation = bullet_turn(state.angular_velocity, dt) * body.pose.rotation;
  }
}

bool NearColliders::nearest(int piece, const Vec3& point, double reach, signed char& side,
                            NearSurface& surface) const {
  const Impl::Part& part = impl_->parts[at(piece)];
  const Pose pose = impl_->bodies[at(part.seen.collider)].pose * part.local;
  const Vec3 local = pose.to_local(point);
  if (part.seen.mesh) {
    if (!nearest_on_mesh(*part.shape, local, reach, side, surface)) {
      return false;
    }
  } else {
    if (part.shape->beyond(local, reach)) {
      return false;
    }
    const SurfaceDistance found = part.shape->distance(local);
    if (!(found.distance <= reach)) {
      return false;
    }
    surface.gap = found.distance;
    surface.normal = found.normal;
  }
  surface.normal = pose.rotation * surface.normal;
  return true;
}

std::span<signed char> NearColliders::sides(int piece) const { return impl_->parts[at(piece)].sides; }

void NearColliders::candidates(int piece, std::span<const Vec3> points, double reach,
                               std::vector<int>& out) const {
  out.clear();
  const Impl::Part& part = impl_->parts[at(piece)];
  const ColliderShape& shape = *part.shape;
  if (shape.kind == ColliderShape::Kind::mesh && shape.facets.empty()) {
    return;
  }
  const Pose pose = impl_->bodies[at(part.seen.collider)].pose * part.local;
  Vec3 low = shape.bounds_min, high = shape.bounds_max;
  if (shape.kind == ColliderShape::Kind::mesh && !shape.facet_tree.empty()) {
    low = shape.facet_tree.bounds().low;
    high = shape.facet_tree.bounds().high;
  }
  const bool plane = shape.kind == ColliderShape::Kind::plane;
  for (std::size_t v = 0; v < points.size(); ++v) {
    const Vec3 p = pose.to_local(points[v]);
    const double outside = plane ? shape.plane_normal.dot(p) - shape.plane_offset
                                 : std::max((p - high).maxCoeff(), (low - p).maxCoeff());
    if (outside <= reach) {
      out.push_back(static_cast<int>(v));
    }
  }
}

void NearColliders::plane(int piece, Vec3& normal, double& offset) const {
  const Impl::Part& part = impl_->parts[at(piece)];
  const Pose pose = impl_->bodies[at(part.seen.collider)].pose * part.local;
  normal = pose.rotation * part.shape->plane_normal;
  offset = normal.dot(pose.to_world(part.shape->plane_offset * part.shape->plane_normal));
}

}  // namespace softpoint::inline SOFTPOINT_ABI

// Entries of the lists in a snapshot: handles, contacts and what they refer to.
#include <algorithm>
#include <limits>

#include "bullet_archive.h"
#include "deformable_system_impl.h"
#include "snapshot_bytes.h"
#include "softpoint/core/state_archive.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Up to three weighted points.
void archive_points(StateArchive& archive, int least, int points, int& count, std::array<int, 3>& indices,
                    std::array<double, 3>& weights) {
  archive.integer("contact.count", count, least, 3);
  for (std::size_t k = 0; k < 3; ++k) {
    archive.integer("contact.point", indices[k], 0, points - 1);
    archive.number("contact.weight", weights[k]);
  }
}

}  // namespace

// An object of the world, by its place there.
void DeformableSystem::Impl::archive_object(StateArchive& archive, const btCollisionObject*& object) {
  int index = place_of(object);
  archive.integer("collision object", index, 0, world.getNumCollisionObjects() - 1);
  if (archive.loading()) {
    object = world.getCollisionObjectArray()[index];
  }
}

// -1 where it is no longer in the world; `object` may have been deleted then.
int DeformableSystem::Impl::place_of(const btCollisionObject* object) const {
  const btCollisionObjectArray& objects = world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    if (objects[i] == object) {
      return i;
    }
  }
  return -1;
}

void DeformableSystem::Impl::archive_handle(StateArchive& archive, Handle& held) {
  static_assert(sizeof(Handle) == 128, "Handle has changed: archive its new members, raise kSnapshotVersion");
  archive.integer("handle.id", held.id, 1, kMostLong);
  archive.integer("handle.body", held.body, 0, static_cast<int>(bodies.size()) - 1);
  const auto points = static_cast<int>(bodies[static_cast<std::size_t>(held.body)]->points().size());
  archive.integer("handle.point", held.point, 0, points - 1);
  archive.vector("handle.target", held.target);
  archive.number("handle.max_force", held.max_force, 0.0, kInfinity);
  archive.vector("handle.impulse", held.impulse);
  archive.flag("handle.unreached", held.unreached);
  bool anchored = held.anchored();
  archive.read_flag("handle.anchored", anchored);
  if (anchored) {
    archive_object(archive, held.object);
    if (held.object->getInternalType() == btCollisionObject::CO_SOFT_BODY) {
      archive.refuse("handle.object", "a soft body; permitted are other objects");
    }
    archive.flag("handle.collide", held.collide);
  } else if (archive.loading()) {
    held.object = nullptr;
    held.collide = true;
  }
  held.own = bodies[static_cast<std::size_t>(held.body)]->solves_contact();
}

void DeformableSystem::Impl::archive_contact(StateArchive& archive, Contact& contact) {
  static_assert(sizeof(Contact) == 296,
                "Contact has changed: archive its new members, raise kSnapshotVersion");
  const auto count = [&](int body) {
    return static_cast<int>(bodies[static_cast<std::size_t>(body)]->points().size());
  };
  archive.integer("contact.body", contact.body, 0, static_cast<int>(bodies.size()) - 1);
  archive_object(archive, contact.object);
  contact.other_body = index_of(contact.object);
  archive.integer("contact.child", contact.child, 0, kMostInt);
  int kind = static_cast<int>(contact.kind);
  archive.integer("contact.kind", kind, 0, static_cast<int>(ContactKind::face));
  contact.kind = static_cast<ContactKind>(kind);
  archive.integer("contact.rigid_feature", contact.rigid_feature, -kMostInt, kMostInt);
  const Deformable& body = *bodies[static_cast<std::size_t>(contact.body)];
  const std::size_t features = contact.kind == ContactKind::face   ? body.triangles_.size()
                               : contact.kind == ContactKind::edge ? body.edges_.size()
                                                                   : body.positions_.size();
  archive.integer("contact.skin_feature", contact.skin_feature, contact.kind == ContactKind::corner ? -1 : 0,
                  static_cast<int>(features) - 1);
  archive_points(archive, 1, count(contact.body), contact.count, contact.points, contact.weights);
  archive_points(archive, 0, contact.other_body >= 0 ? count(contact.other_body) : 1, contact.other_count,
                 contact.other_points, contact.other_weights);
  archive.vector("contact.normal", contact.normal);
  archive.number("contact.gap", contact.gap);
  archive.vector("contact.rigid_point", contact.rigid_point);
  archive.vector("contact.arm", contact.arm);
  archive.number("contact.friction", contact.friction, 0.0, kMost);
  archive.flag("contact.fresh", contact.fresh);
  archive.number("contact.restitution", contact.restitution);
  archive.number("contact.approach", contact.approach);
  archive.number("contact.fall_speed", contact.fall_speed);
  archive.flag("contact.faded", contact.faded);
  archive.number("contact.rebound", contact.rebound);
  archive.vector("contact.impulse", contact.impulse);
}

void DeformableSystem::Impl::archive_contact_point(StateArchive& archive, ContactPoint& point) {
  int body = std::max(index_of(point.body), 0);
  archive.integer("contact point.body", body, 0, static_cast<int>(bodies.size()) - 1);
  if (archive.loading()) {
    point.body = bodies[static_cast<std::size_t>(body)];
  }
  archive_object(archive, point.other);
  archive.vector("contact point.point", point.point);
  archive.vector("contact point.normal", point.normal);
  archive.vector("contact point.force", point.force);
  archive.number("contact point.gap", point.gap);
}

void DeformableSystem::Impl::archive_surrounding(StateArchive& archive, Surrounding& near) {
  int body = std::max(index_of(near.body), 0);
  archive.integer("surrounding.body", body, 0, static_cast<int>(bodies.size()) - 1);
  if (archive.loading()) {
    near.body = bodies[static_cast<std::size_t>(body)];
  }
  archive_object(archive, near.object);
  archive_bullet(archive, "surrounding.pose", near.pose);
}

}  // namespace softpoint::inline SOFTPOINT_ABI

// What a snapshot of a DeformableSystem holds, and how it is checked and taken over.
#include <algorithm>
#include <limits>

#include "bullet_archive.h"
#include "deformable_system_impl.h"
#include "snapshot_bytes.h"
#include "softpoint/core/error.h"
#include "softpoint/core/state_archive.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMost = std::numeric_limits<double>::max();
constexpr int kMostInt = std::numeric_limits<int>::max();
constexpr long long kMostLong = std::numeric_limits<long long>::max();
constexpr long long kMostEntries = 100'000'000;

void archive_settings(StateArchive& archive, ContactSettings& s) {
  archive.number("settings.margin", s.margin, 1e-5, 0.1);
  archive.number("settings.tolerance", s.tolerance, 1e-12, 1e-2);
  archive.integer("settings.max_iterations", s.max_iterations, 1, 10000);
  archive.integer("settings.max_passes", s.max_passes, 1, 20);
  archive.number("settings.rebound_speed", s.rebound_speed, 0.0, kMost);
  archive.flag("settings.rigid_support", s.rigid_support);
}

void archive_totals(StateArchive& archive, Profile::Totals& t) {
  archive.integer("totals.substeps", t.substeps, 0, kMostLong);
  archive.integer("totals.guard_fired", t.guard_fired, 0, kMostLong);
  archive.integer("totals.late_substeps", t.late_substeps, 0, kMostLong);
  archive.integer("totals.refactorizations", t.refactorizations, 0, kMostLong);
  archive.integer("totals.anchors_released", t.anchors_released, 0, kMostLong);
}

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

void Deformable::archive_state(StateArchive&) {}

void Deformable::archive(StateArchive& archive) {
  archive.constant("kind", kind());
  archive.constant("number of points", static_cast<std::uint64_t>(positions_.size()));
  archive.constant("hash of the faces", state_hash(triangles_.data(), triangles_.size() * sizeof(Triangle)));
  archive.constant("hash of the masses", state_hash(masses_.data(), masses_.size() * sizeof(double)));
  archive.vectors("position", positions_);
  archive.vectors("velocity", velocities_);
  archive.vectors("impulse", impulses_);
  archive.flag("impulses queued", impulses_queued_);
  archive.vector("acceleration", acceleration_);
  archive.integer("times the guard fired", guard_fired_, 0, kMostLong);
  archive.integer("refactorizations", refactorizations_, 0, kMostLong);

  archive.number("sleep_settings.speed", sleep_settings_.speed, 0.0, 1e6);
  bool has_time = sleep_settings_.time.has_value();
  double time = sleep_settings_.time.value_or(0.0), resting = getDeactivationTime();
  archive.flag("sleep_settings.time set", has_time);
  archive.number("sleep_settings.time", time, 0.0, 1e6);
  archive.flag("asleep", asleep_);
  int activation = getActivationState(), island = getIslandTag();
  archive.integer("activation state", activation, ACTIVE_TAG, DISABLE_SIMULATION);
  archive.number("deactivation time", resting, 0.0, 1e30);
  archive.integer("island", island, -1, kMostInt);
  Vec3 low = from_bullet(m_bounds[0]), high = from_bullet(m_bounds[1]);
  archive.vector("bounds", low);
  archive.vector("bounds", high);
  archive_state(archive);
  if (!archive.loading()) {
    return;
  }
  sleep_settings_.time = has_time ? std::optional<double>(time) : std::nullopt;
  forceActivationState(activation);
  setDeactivationTime(static_cast<btScalar>(resting));
  setIslandTag(island);
  end_positions_ = free_positions_ = impulse_points_ = positions_;
  mirror(0.0);
  m_bounds[0] = to_bullet(low);
  m_bounds[1] = to_bullet(high);
}

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
    archive.flag("handle.collide", held.collide);
  } else if (archive.loading()) {
    held.object = nullptr;
    held.collide = true;
  }
}

// Of anchors that keep body and object from colliding.
void DeformableSystem::Impl::forbid_collisions(bool forbid) {
  for (const std::vector<Handle>* list : {&handles, &resting_handles_}) {
    for (const Handle& held : *list) {
      if (held.anchored() && !held.collide) {
        bodies[static_cast<std::size_t>(held.body)]->setIgnoreCollisionCheck(held.object, forbid);
      }
    }
  }
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

void DeformableSystem::Impl::archive(StateArchive& archive, SnapshotScope& scope) {
  archive.begin("system");
  bool with_world = scope == SnapshotScope::world;
  archive.read_flag("with the world", with_world);
  scope = with_world ? SnapshotScope::world : SnapshotScope::deformables;
  archive.constant("number of bodies", static_cast<std::uint64_t>(bodies.size()));
  archive.constant("number of collision objects in the world",
                   static_cast<std::uint64_t>(world.getNumCollisionObjects()));
  archive_settings(archive, settings);
  archive_totals(archive, profile.totals);
  archive.integer("next handle", next_handle, 1, kMostLong);
  archive.number("last time step", last_dt_, 0.0, kMost);
  Vec3 gravity = from_bullet(known_gravity_);
  archive.vector("gravity", gravity);
  known_gravity_ = to_bullet(gravity);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    archive.begin("body", static_cast<long long>(b));
    bodies[b]->archive(archive);
  }
  archive.begin("system");
  const auto handle_entry = [&](Handle& held) { archive_handle(archive, held); };
  const long long none_without_bodies = bodies.empty() ? 0 : kMostEntries;
  archive.list("handles", handles, none_without_bodies, handle_entry);
  archive.list("handles of sleeping bodies", resting_handles_, none_without_bodies, handle_entry);
  archive.list("contacts", contacts_.all(), none_without_bodies,
               [&](Contact& contact) { archive_contact(archive, contact); });
  archive.list("contacts of sleeping bodies", resting_contacts_, none_without_bodies,
               [&](RestingContact& resting) {
                 archive_contact(archive, resting.contact);
                 archive.number("contact.dt", resting.dt, 1e-30, kMost);
               });
  archive.list("surroundings", surroundings_, none_without_bodies,
               [&](Surrounding& near) { archive_surrounding(archive, near); });
  archive.list("contact points", contact_points, none_without_bodies,
               [&](ContactPoint& point) { archive_contact_point(archive, point); });
  if (with_world) {
    archive_world(archive);
  }
}

template <class Describe>
void Snapshot::write(Describe describe) {
  bytes_.resize(kSnapshotHeader);
  StateArchive archive(bytes_);
  describe(archive);
  seal_snapshot(bytes_);
}

template <class Describe>
void Snapshot::take(Describe describe) const {
  const std::span<const std::byte> state = std::span(bytes_).subspan(kSnapshotHeader);
  StateArchive checking(state, StateArchive::Mode::check);
  describe(checking);
  if (checking.offset_ != state.size()) {
    checking.refuse("end",
                    std::to_string(state.size() - checking.offset_) +
                        " bytes more than this system has; permitted is a snapshot of this very system");
  }
  StateArchive loading(state, StateArchive::Mode::load);
  describe(loading);
}

void DeformableSystem::save(Snapshot& into, SnapshotScope scope) const {
  impl_->check_between_steps("save");
  impl_->drop_vanished();
  into.write([&](StateArchive& archive) { impl_->archive(archive, scope); });
}

Snapshot DeformableSystem::save(SnapshotScope scope) const {
  Snapshot snapshot;
  save(snapshot, scope);
  return snapshot;
}

void DeformableSystem::restore(const Snapshot& snapshot) {
  impl_->check_between_steps("restore");
  if (snapshot.empty()) {
    throw Error("restore: the snapshot is empty; permitted is one that save() made");
  }
  SnapshotScope scope = SnapshotScope::deformables;
  impl_->release_lost_anchors();
  impl_->forbid_collisions(false);
  try {
    snapshot.take([&](StateArchive& archive) { impl_->archive(archive, scope); });
  } catch (...) {
    impl_->forbid_collisions(true);
    throw;
  }
  impl_->forbid_collisions(true);
  impl_->taken_over();
  if (scope == SnapshotScope::world) {
    impl_->flush_contact_caches();
  }
}

void DeformableSystem::flush_contact_caches() {
  impl_->check_between_steps("flush_contact_caches");
  impl_->forget_meshes();
  impl_->flush_contact_caches();
}

void DeformableSystem::Impl::check_between_steps(const char* caller) const {
  if (open_) {
    throw Error(std::string(caller) + ": called within a step; permitted is between two steps");
  }
}

// Nothing may be left of objects that have gone since the last step.
void DeformableSystem::Impl::drop_vanished() {
  release_lost_anchors();
  const auto vanished = [&](const auto& entry) { return place_of(entry.object) < 0; };
  contacts_.erase_if(vanished);
  std::erase_if(resting_contacts_, [&](const RestingContact& r) { return vanished(r.contact); });
  std::erase_if(surroundings_, vanished);
  std::erase_if(contact_points, [&](const ContactPoint& p) { return place_of(p.other) < 0; });
}

void DeformableSystem::Impl::forget_meshes() {
  for (ContactFinder& finder : finders_) {
    finder.forget_meshes();
  }
}

void DeformableSystem::Impl::taken_over() {
  contacts_.reindex();
  pairs_.clear();
  forget_meshes();
  restored_ = true;
}

}  // namespace softpoint::inline SOFTPOINT_ABI

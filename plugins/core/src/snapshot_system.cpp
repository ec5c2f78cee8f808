// What a snapshot of a DeformableSystem holds, and how it is checked and taken over.
#include <algorithm>

#include "deformable_system_impl.h"
#include "snapshot_bytes.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"
#include "softpoint/core/state_archive.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

constexpr long long kMostEntries = 100'000'000;

void archive_settings(StateArchive& archive, ContactSettings& s) {
  archive.number("settings.margin", s.margin, 1e-5, 0.1);
  archive.number("settings.tolerance", s.tolerance, 1e-12, 1e-2);
  archive.integer("settings.max_iterations", s.max_iterations, 1, 10000);
  archive.integer("settings.max_passes", s.max_passes, 1, 20);
  archive.number("settings.rebound_speed", s.rebound_speed, 0.0, kMaxSpeed);
  archive.flag("settings.rigid_support", s.rigid_support);
}

void archive_totals(StateArchive& archive, Profile::Totals& t) {
  archive.integer("totals.substeps", t.substeps, 0, kMostLong);
  archive.integer("totals.guard_fired", t.guard_fired, 0, kMostLong);
  archive.integer("totals.late_substeps", t.late_substeps, 0, kMostLong);
  archive.integer("totals.refactorizations", t.refactorizations, 0, kMostLong);
  archive.integer("totals.anchors_released", t.anchors_released, 0, kMostLong);
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
    if (bodies[b]->solves_contact()) {
      archive_own_loads(archive, static_cast<int>(b));
    }
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
  std::erase_if(own_loads_, vanished);
  std::erase_if(contact_points, [&](const ContactPoint& p) { return place_of(p.other) < 0; });
}

void DeformableSystem::Impl::forget_meshes() {
  mesh_sides_.clear();
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

// Stage of a substep: what touches in the configuration that the end of the step would have.
#include <algorithm>

#include "deformable_system_impl.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Contacts of the end of the step as it stands; returns the worst violation of a margin (m).
double DeformableSystem::Impl::detect(bool first) {
  StageTimer timer(profile.seconds.detect);
  finders_.resize(bodies.size());
  for (Contact& contact : contacts_.all()) {
    contact.seen = false;
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b]->asleep()) {
      finders_[b].begin_pass(static_cast<int>(b), *bodies[b], settings.margin, first);
    }
  }
  for (const PlacedShape& placed : placed_) {
    detect_on_shape(placed);
  }
  for (std::size_t i = 0; i < skin_pairs_.size(); ++i) {
    detect_between(skin_pairs_[i], static_cast<int>(i));
  }
  double worst = 0.0;
  for (Contact& contact : contacts_.all()) {
    // What carried load between two deformables may be out of reach where last step's impulses lead: without
    // any of it they would spring through each other.
    const bool carried = first && contact.other_body >= 0 && contact.impulse != Vec3::Zero();
    const bool known = contact.met || contact.kind == ContactKind::face || carried;
    if (!contact.seen && contact.shape_index >= 0 && known) {
      contact.seen = refresh(contact);
      contact.met |= carried && contact.seen;
    }
    if (contact.seen) {
      worst = std::max(worst, -contact.gap);
    }
  }
  return worst;
}

void DeformableSystem::Impl::detect_on_shape(const PlacedShape& placed) {
  ContactFinder& finder = finders_[static_cast<std::size_t>(placed.body)];
  const ColliderShape& shape = *placed.instance.collider;
  const RigidState& rigid = rigid_[placed.instance.rigid];
  if (shape.kind == ColliderShape::Kind::mesh) {
    finder.find_vertices_on_mesh(placed.instance, rigid, contacts_);
  } else {
    finder.find_vertices(placed.instance, rigid, contacts_);
  }
  if (shape.meets_faces()) {
    finder.find_faces(placed.instance, rigid, contacts_);
  } else if (!shape.corners.empty()) {  // a plane touches vertices only
    const RigidFeatures features(placed.instance, rigid);
    finder.find_corners(features, rigid, contacts_);
    finder.find_edges(features, rigid, contacts_);
  }
}

// Vertices of each against the other's faces, edges against edges.
void DeformableSystem::Impl::detect_between(const SkinPair& pair, int index) {
  ContactFinder& first = finders_[static_cast<std::size_t>(pair.first)];
  ContactFinder& second = finders_[static_cast<std::size_t>(pair.second)];
  const SkinFeatures of_first(first.skin(), pair.first, pair.first_rigid, index);
  const SkinFeatures of_second(second.skin(), pair.second, pair.second_rigid, index);
  first.find_corners(of_second, rigid_[pair.second_rigid], contacts_);
  second.find_corners(of_first, rigid_[pair.first_rigid], contacts_);
  first.find_edges(of_second, rigid_[pair.second_rigid], contacts_);
}

bool DeformableSystem::Impl::refresh(Contact& contact) {
  ContactFinder& finder = finders_[static_cast<std::size_t>(contact.body)];
  const RigidState& rigid = rigid_[contact.rigid];
  if (contact.kind == ContactKind::corner && contact.other_body >= 0) {
    const Skin& other = finders_[static_cast<std::size_t>(contact.other_body)].skin();
    return finder.refresh_corner(SkinFeatures(other, contact.other_body, contact.rigid, contact.shape_index),
                                 rigid, contact);
  }
  if (contact.kind == ContactKind::corner) {
    const ShapeInstance& instance = placed_[static_cast<std::size_t>(contact.shape_index)].instance;
    return finder.refresh_corner(RigidFeatures(instance, rigid), rigid, contact);
  }
  if (contact.kind == ContactKind::face) {
    return finder.refresh_face(placed_[static_cast<std::size_t>(contact.shape_index)].instance, rigid,
                               contact);
  }
  finder.refresh_on_plane(other_point(contact), contact);
  return true;
}

Vec3 DeformableSystem::Impl::other_point(const Contact& contact) const {
  if (contact.other_body < 0) {
    return rigid_[contact.rigid].end.to_world(contact.rigid_point);
  }
  const Deformable& other = *bodies[static_cast<std::size_t>(contact.other_body)];
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < static_cast<std::size_t>(contact.other_count); ++k) {
    sum += contact.other_weights[k] * other.end_positions_[static_cast<std::size_t>(contact.other_points[k])];
  }
  return sum;
}

}  // namespace softpoint::inline SOFTPOINT_ABI

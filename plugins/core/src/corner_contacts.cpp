// Corners, of shapes or of another skin, against the faces of a deformable.
#include <algorithm>
#include <cmath>

#include "contact_finder.h"

namespace softpoint::inline SOFTPOINT_ABI {

void ContactFinder::find_corners(const FeatureSource& source, const RigidState& rigid,
                                 ContactTable& contacts) {
  skin();
  const Vec3 size = skin_.size();
  const double reach = std::max(0.02, 0.1 * size.maxCoeff());
  source.corners_in(skin_.bounds().grown(reach + skin_.travel() + source.travel()), features_);
  Contact name;
  name.body = body_index_;
  name.kind = ContactKind::corner;
  source.identify(name);
  for (const int i : features_) {
    const FeatureSource::Corner corner = source.corner(i);
    const Vec3& to = corner.end;
    // Its path as seen from the body.
    const Vec3 from = corner.start + skin_.drift();
    Bounds path = Bounds::of(from);
    path.include(to);
    if (skin_.bounds().grown(reach).misses(path)) {
      continue;
    }
    SkinPoint hit;
    const bool far_moved = (to - from).squaredNorm() > kTrustedDepth * kTrustedDepth;
    if (!(far_moved && skin_.crossed_face(from, to, hit))) {
      hit = {};
      if (!skin_.nearest_face(to, reach, hit)) {
        hit = {};
        if (skin_.bounds().misses(Bounds::of(to)) || !skin_.inside(to) ||
            !skin_.nearest_face(to, size.norm(), hit)) {
          continue;
        }
      }
      const bool at_vertex = hit.weights.maxCoeff() > 1.0 - 1e-9;
      if (hit.distance > 0.0 && at_vertex && name.other_body < 0) {
        continue;  // vertices of the skin make contacts of their own
      }
    }
    if (hit.distance - margin_ > kSlackMargins * margin_) {
      continue;
    }
    const Vec3 direction = source.press_direction(i, skin_.smooth_normal(hit.face, hit.weights), hit.outward);
    if (direction == Vec3::Zero()) {
      continue;
    }
    name.rigid_feature = i;
    Contact& contact = contacts.find_or_add(name);
    if (contact.met) {
      continue;  // refresh_corner() follows it in the direction in which it began to press
    }
    contact.normal = direction;
    SkinPoint along;
    if (skin_.along(to, direction, 2.0 * std::abs(hit.distance) + 0.25 * size.norm(), along)) {
      hit = along;
    }
    contact.gap = hit.distance - margin_;
    source.place_corner(i, contact);
    place_on_face(hit.face, hit.weights, rigid, contact);
    contact.seen = contact.met = true;
  }
}

bool ContactFinder::refresh_corner(const FeatureSource& source, const RigidState& rigid, Contact& contact) {
  skin();
  SkinPoint along;
  if (!skin_.along(source.corner(contact.rigid_feature).end, contact.normal, 0.5 * skin_.size().norm(),
                   along)) {
    return false;
  }
  contact.gap = along.distance - margin_;
  place_on_face(along.face, along.weights, rigid, contact);
  return true;
}

}  // namespace softpoint::inline SOFTPOINT_ABI

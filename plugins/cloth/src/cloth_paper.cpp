// One step of a cloth in the `paper` mode: hands, one plane, one bubble, and nothing else of the world.
#include <algorithm>

#include "cloth_state.h"
#include "paper_cloth.h"
#include "softpoint/core/near_colliders.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// m; where there is no plane, one is put so far below that nothing gets there.
constexpr double kFarBelow = 100.0;

}  // namespace

bool Cloth::State::paper_plane(const NearColliders& near, const Vec3& acceleration) {
  const Vec3 middle = positions[positions.size() / 2];
  for (int piece = 0; piece < near.pieces(); ++piece) {
    if (!near.piece(piece).plane) continue;
    Vec3 normal;
    double offset = 0;
    near.plane(piece, normal, offset);
    offset += 0.5 * design.fabric.thickness;
    if (!paper_on_plane || paper_normal != normal || paper_offset != offset) {
      paper->set_plane(normal, middle + (offset - normal.dot(middle)) * normal);
    }
    paper_on_plane = true, paper_normal = normal, paper_offset = offset;
    paper->set_friction(near.collider(near.piece(piece).collider).friction);
    return true;
  }
  paper_on_plane = false;
  const double pull = acceleration.norm();
  const Vec3 up = pull > 0 ? Vec3(-acceleration / pull) : Vec3(Vec3::UnitY());
  paper->set_plane(up, middle - kFarBelow * up);
  return false;
}

void Cloth::State::advance_paper(double step, const Vec3& acceleration, NearColliders& near,
                                 std::span<HeldPoint> held) {
  if (paper->positions() != positions || paper->velocities() != velocities) {
    paper->set_state(positions, velocities);
  }
  const bool plane = paper_plane(near, acceleration);
  paper->set_gravity(acceleration);
  paper->set_air_on(plane && airy());
  if (plane && paper_air < 0) {
    paper_air = design.air.initial_volume.value_or(std::max(0.0, paper->volume()));
  }
  paper->set_air(std::max(0.0, paper_air), design.air.ambient);
  paper_hands.clear();
  for (const HeldPoint& point : held) {
    const ClothHand hand = hand_for(point, step, near);
    paper_hands.push_back({hand.point, hand.target, hand.velocity});
  }
  paper->set_hands(paper_hands);
  near.begin(step);
  {
    StageTimer timer(profile.seconds.solve);
    profile.counts.substeps = paper->step(step);
  }
  near.advance(step);
  positions = paper->positions();
  velocities = paper->velocities();

  bubbles.clear();
  profile.counts.air_skipped = !(plane && airy());
  if (plane && airy()) {
    double area = 0;
    for (double part : point_areas) area += part;
    const double pressure = design.air.ambient + paper->gauge();
    bubbles.push_back({static_cast<int>(design.pattern.faces.size()), area, paper->volume(), pressure,
                       design.air.ambient * std::max(0.0, paper_air), false});
    profile.counts.pockets = 1;
  }
  next_targets.clear();
  for (HeldPoint& point : held) {
    point.impulse += step * paper->hand_force(point.point);
    if (point.collider < 0) {
      next_targets.push_back({point.handle, point.target, hand_for(point, 0.0, near).velocity});
    }
  }
  std::swap(last_targets, next_targets);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

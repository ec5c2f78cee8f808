#include "self_zones.h"

#include <numeric>

#include "disjoint_sets.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// Of the thickness: nearer than this counts as through; what is nearer already may still lose this much of
// its distance.
constexpr double kLeast = 0.1, kShrinks = 0.9;
constexpr int kJoinRounds = 30;

}  // namespace

bool SelfZones::crosses(const SelfMeeting& meeting, const Motion& motion) const {
  Vec3 x[4], ways[4], end[4];
  meeting.pair.corners(motion.before, x);
  meeting.pair.corners(motion.positions, end);
  for (int k = 0; k < 4; ++k) ways[k] = end[k] - x[k];
  // A plane that parts them at both ends of the small step parts them all along.
  double first[4];
  for (int k = 0; k < 4; ++k) first[k] = meeting.normal.dot(end[k]);
  const double gap = meeting.pair.edges ? std::min(first[0], first[1]) - std::max(first[2], first[3])
                                        : first[0] - std::max({first[1], first[2], first[3]});
  const double least = std::min(kShrinks * meeting.nearest.distance, kLeast * meeting.thickness);
  if (gap > least) return false;
  return !stay_apart(meeting.pair.edges, x, ways, least);
}

bool SelfZones::unite(const SelfPair& pair) {
  const DisjointSets sets(parents_);
  bool fresh = false;
  for (int k = 1; k < 4; ++k) {
    fresh |= sets.find(pair.v[0]) != sets.find(pair.v[k]);
    sets.unite(pair.v[0], pair.v[k]);
  }
  return fresh;
}

// Each zone by the mean of its ways, but not into what its points lie on; what is held takes all along.
void SelfZones::move(const Motion& motion) {
  const DisjointSets sets(parents_);
  std::size_t count = 0;
  for (std::size_t v = 0; v < parents_.size(); ++v) {
    members_[v] = {sets.find(static_cast<int>(v)), static_cast<int>(v)};
  }
  count = members_.size();
  std::sort(members_.begin(), members_.end(), [](const Member& a, const Member& b) {
    return a.root != b.root ? a.root < b.root : a.point < b.point;
  });
  for (std::size_t i = 0; i < count;) {
    std::size_t end = i + 1;
    while (end < count && members_[end].root == members_[i].root) ++end;
    if (end - i > 1) {
      Vec3 way = Vec3::Zero(), speed = Vec3::Zero();
      double mass = 0;
      bool held = false;
      for (std::size_t m = i; m < end; ++m) {
        const auto v = static_cast<std::size_t>(members_[m].point);
        const bool fixed = motion.inverse_masses[v] == 0;
        if (fixed && !held) way.setZero(), speed.setZero(), mass = 0, held = true;
        if (held && !fixed) continue;
        const double own = fixed ? 1 : 1 / motion.inverse_masses[v];
        way += own * (motion.positions[v] - motion.before[v]);
        speed += own * motion.velocities[v];
        mass += own;
      }
      way /= mass;
      speed /= mass;
      for (std::size_t m = i; m < end; ++m) {
        const auto v = static_cast<std::size_t>(members_[m].point);
        for (int k = 0; k < motion.contacts[v].count; ++k) {
          const ContactPlane& plane = motion.contacts[v].planes[k];
          const double room = plane.normal.dot(motion.before[v] - plane.foot - motion.h * plane.velocity);
          const double into = -std::max(room, 0.0) - plane.normal.dot(way);
          if (into <= 0) continue;
          way += into * plane.normal;
          const double fall = plane.normal.dot(plane.velocity - speed);
          if (fall > 0) speed += fall * plane.normal;
        }
      }
      for (std::size_t m = i; m < end; ++m) {
        const auto v = static_cast<std::size_t>(members_[m].point);
        motion.positions[v] = motion.before[v] + way;
        motion.velocities[v] = speed;
      }
    }
    i = end;
  }
}

int SelfZones::join(const Motion& motion, std::span<const SelfMeeting> meetings) {
  bool any = false;
  for (int round = 0; round < kJoinRounds; ++round) {
    bool fresh = false;
    for (const SelfMeeting& meeting : meetings) {
      if (!crosses(meeting, motion)) continue;
      if (!any) std::iota(parents_.begin(), parents_.end(), 0);
      any = true;
      fresh |= unite(meeting.pair);
    }
    if (!fresh) break;
    if (round == kJoinRounds - 2) {
      for (const SelfMeeting& meeting : meetings) unite(meeting.pair);
    }
    move(motion);
  }
  if (!any) return 0;
  int joined = 0;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    joined += (i > 0 && members_[i].root == members_[i - 1].root) ||
              (i + 1 < members_.size() && members_[i].root == members_[i + 1].root);
  }
  return joined;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

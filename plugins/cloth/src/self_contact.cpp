#include "self_contact.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// What a frame may cost at most, however wild: pairs a point, pairs of faces a face, searches. What is left
// out is counted (Counts::dropped).
constexpr std::size_t kMostPairs = 16;
constexpr int kMostFacePairs = 24;
constexpr int kMostSearches = 10;
// Two faces give at most nine pairs of edges and six of points and faces.
constexpr std::size_t kPairsOfFaces = 15;
// Of the spacing: how far points move before near pairs are looked for anew.
constexpr double kRoom = 0.3;
// Rounds of corrections after a small step.
constexpr int kRounds = 4;
// Edges whose directions have a smaller sine have no common normal worth the name; their points meet faces.
constexpr double kParallel = 0.05;
// m; smaller motions are taken as they are.
constexpr double kWorthFitting = 2e-4;

}  // namespace

bool SelfContactPass::before_in_list(const Pair& a, const Pair& b) {
  return a.edges != b.edges
             ? a.edges < b.edges
             : std::lexicographical_compare(std::begin(a.v), std::end(a.v), std::begin(b.v), std::end(b.v));
}

SelfContactPass::SelfContactPass(const ClothPattern& pattern, double thickness)
    : patches_(pattern), thickness_(thickness), room_(kRoom * pattern.spacing) {
  searched_at_.assign(pattern.points.size(), Vec3::Zero());
  pairs_.reserve(kMostPairs * pattern.points.size() + kPairsOfFaces);
  crossed_.reserve(pairs_.capacity());
}

void SelfContactPass::forget() {
  known_ = false;
  pairs_.clear();
}

// How far points have moved against each other, at most half of it (m): against the middle one of the list,
// or, where that is much, against the motion of the whole as a rigid body.
double SelfContactPass::spread(std::span<const Vec3> to, std::span<const Vec3> from) {
  const std::size_t count = to.size();
  const Vec3 shared = to[count / 2] - from[count / 2];
  double farthest = 0;
  for (std::size_t v = 0; v < count; ++v) {
    farthest = std::max(farthest, (to[v] - from[v] - shared).squaredNorm());
  }
  if (farthest < kWorthFitting * kWorthFitting) {
    return std::sqrt(farthest);
  }
  Vec3 center = Vec3::Zero(), shift = Vec3::Zero();
  for (std::size_t v = 0; v < count; ++v) {
    center += from[v];
    shift += to[v] - from[v];
  }
  center /= static_cast<double>(count);
  shift /= static_cast<double>(count);
  Mat3 inertia = Mat3::Zero();
  Vec3 turning = Vec3::Zero();
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3 arm = from[v] - center;
    inertia += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
    turning += arm.cross(to[v] - from[v]);
  }
  inertia.diagonal().array() += 1e-12 * inertia.trace() + 1e-300;
  const Vec3 turn = inertia.inverse() * turning;
  double fitted = 0;
  for (std::size_t v = 0; v < count; ++v) {
    fitted = std::max(fitted, (to[v] - from[v] - shift - turn.cross(from[v] - center)).squaredNorm());
  }
  // A turn also brings points nearer that are seen to move along; by half its square.
  return std::min(std::sqrt(farthest), std::sqrt(fitted) + turn.squaredNorm() * 0.5);
}

bool SelfContactPass::begin_frame(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                                  double dt) {
  if (!known_ || !pairs_.empty()) {
    return true;
  }
  double fastest = 0;
  const Vec3& shared = velocities[velocities.size() / 2];
  for (const Vec3& v : velocities) {
    fastest = std::max(fastest, (v - shared).squaredNorm());
  }
  constexpr double kSurprise = 4.0;  // times faster than seen
  return spread(positions, searched_at_) + kSurprise * dt * std::sqrt(fastest) >= 0.5 * (reach_ - thickness_);
}

void SelfContactPass::search(std::span<const Vec3> positions) {
  ++counts.searches;
  crossed_.clear();
  for (const Pair& pair : pairs_) {
    if (pair.side != 0 && pair.due <= travel_) {
      crossed_.push_back(pair);  // touching: the side it is on is not to be asked anew
    }
  }
  std::sort(crossed_.begin(), crossed_.end(), before_in_list);
  travel_ = 0;
  pairs_.clear();
  most_face_pairs_ = kMostFacePairs * static_cast<int>(patches_.faces().size());
  patches_.measure(positions, 0.5 * reach_);
  counts.patch_pairs = patches_.near_faces(positions, reach_, [&](int face, int other) {
    if (--most_face_pairs_ < 0 || pairs_.size() + kPairsOfFaces > pairs_.capacity()) {
      ++counts.dropped;
      return;
    }
    consider(face, other, positions);
    consider(other, face, positions);
  });
  for (Pair& pair : pairs_) {
    const auto old = std::lower_bound(crossed_.begin(), crossed_.end(), pair, before_in_list);
    if (old != crossed_.end() && !before_in_list(pair, *old)) {
      pair.side = old->side;
    }
  }
  std::copy(positions.begin(), positions.end(), searched_at_.begin());
  known_ = true;
  counts.pairs = static_cast<int>(pairs_.size());
}

// Points that `face` owns against `other`; its edges against those of `other` (each pair of edges once: the
// caller comes with both orders).
void SelfContactPass::consider(int face, int other, std::span<const Vec3> positions) {
  const SelfPatches::Owned& mine = patches_.owned(face);
  const Triangle& there = patches_.faces()[static_cast<std::size_t>(other)];
  const double reach = reach_;
  const auto at = [&](int v) -> const Vec3& { return positions[static_cast<std::size_t>(v)]; };
  for (const int p : mine.points) {
    if (p < 0 || p == there[0] || p == there[1] || p == there[2]) {
      continue;
    }
    // Outside the face's box by more than `reach`?
    const Vec3 low = at(there[0]).cwiseMin(at(there[1])).cwiseMin(at(there[2])),
               high = at(there[0]).cwiseMax(at(there[1])).cwiseMax(at(there[2]));
    if ((low - at(p)).cwiseMax(at(p) - high).maxCoeff() > reach) {
      continue;
    }
    const Vec3 normal = (at(there[1]) - at(there[0])).cross(at(there[2]) - at(there[0]));
    const double area = normal.norm();
    const double height = area > 0.0 ? normal.dot(at(p) - at(there[0])) / area : 0.0;
    if (std::abs(height) <= reach) {
      pairs_.push_back({{p, there[0], there[1], there[2]}, false, 0, 0.0});
    }
  }
  if (face > other) {
    return;
  }
  const SelfPatches::Owned& others = patches_.owned(other);
  for (const int e : mine.edges) {
    for (const int g : others.edges) {
      if (e < 0 || g < 0) {
        continue;
      }
      const auto [a, b] = patches_.edges()[static_cast<std::size_t>(e)];
      const auto [c, d] = patches_.edges()[static_cast<std::size_t>(g)];
      if (a == c || a == d || b == c || b == d) {
        continue;
      }
      const Vec3 low = at(a).cwiseMin(at(b)), high = at(a).cwiseMax(at(b));
      const Vec3 other_low = at(c).cwiseMin(at(d)), other_high = at(c).cwiseMax(at(d));
      if ((low - other_high).cwiseMax(other_low - high).maxCoeff() > reach) {
        continue;
      }
      Pair pair{{a, b, c, d}, true, 0, 0.0};
      const double height = std::abs(gap_of(pair, positions).height);
      if (height <= reach || height > 1e29) {
        pairs_.push_back(pair);
      }
    }
  }
}

// Height of the point over the plane of the face, or distance of the two lines; weights of the four points in
// it.
SelfContactPass::Gap SelfContactPass::gap_of(const Pair& pair, std::span<const Vec3> positions) {
  const Vec3 &a = positions[static_cast<std::size_t>(pair.v[0])],
             &b = positions[static_cast<std::size_t>(pair.v[1])],
             &c = positions[static_cast<std::size_t>(pair.v[2])],
             &d = positions[static_cast<std::size_t>(pair.v[3])];
  Gap gap;
  if (pair.edges) {
    const Vec3 u = b - a, w = d - c, r = c - a;
    const Vec3 normal = u.cross(w);
    const double uu = u.squaredNorm(), ww = w.squaredNorm(), nn = normal.squaredNorm();
    if (nn <= kParallel * kParallel * uu * ww) {
      gap.height = 1e30;
      return gap;
    }
    gap.normal = normal / std::sqrt(nn);
    const double s = r.cross(w).dot(normal) / nn, t = r.cross(u).dot(normal) / nn;
    gap.weights[0] = 1.0 - s;
    gap.weights[1] = s;
    gap.weights[2] = t - 1.0;
    gap.weights[3] = -t;
    gap.height = -r.dot(gap.normal);
    gap.within = s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0;
    return gap;
  }
  const Vec3 e1 = c - b, e2 = d - b, r = a - b;
  const Vec3 normal = e1.cross(e2);
  const double nn = normal.squaredNorm();
  if (!(nn > 0.0)) {
    gap.height = 1e30;
    return gap;
  }
  gap.normal = normal / std::sqrt(nn);
  const double wc = r.cross(e2).dot(normal) / nn, wd = e1.cross(r).dot(normal) / nn, wb = 1.0 - wc - wd;
  gap.weights[0] = 1.0;
  gap.weights[1] = -wb;
  gap.weights[2] = -wc;
  gap.weights[3] = -wd;
  gap.height = r.dot(gap.normal);
  gap.within = wb >= 0.0 && wc >= 0.0 && wd >= 0.0;
  return gap;
}

// Which side the first is on, chosen when the two come within each other: the one it was on where the small
// step began, unless it went round.
void SelfContactPass::choose_side(Pair& pair, const Gap& gap, const Points& points) {
  const double before = gap_of(pair, points.before).height;
  bool through = std::abs(before) < 1e29 && before * gap.height < 0.0;
  if (through) {
    // Where the two were level on their way: within, or past an edge?
    const double time = before / (before - gap.height);
    Vec3 between[4];
    Pair local = pair;
    for (int k = 0; k < 4; ++k) {
      const auto v = static_cast<std::size_t>(pair.v[k]);
      between[k] = points.before[v] + time * (points.positions[v] - points.before[v]);
      local.v[k] = k;
    }
    through = gap_of(local, between).within;
  }
  pair.side = (through ? before : gap.height) < 0.0 ? -1 : 1;
}

// Takes two apart to the thickness and stops their approach, with friction.
bool SelfContactPass::separate(const Pair& pair, const Gap& gap, const Points& points, double friction) {
  const double missing = thickness_ - pair.side * gap.height;
  const Vec3 normal = static_cast<double>(pair.side) * gap.normal;
  double give = 0, give_position = 0, position_mass[4], speed_masses[4];
  Vec3 velocity = Vec3::Zero();
  for (int k = 0; k < 4; ++k) {
    const auto v = static_cast<std::size_t>(pair.v[k]);
    const double inverse = points.inverse_masses[v];
    speed_masses[k] = inverse;
    // A point that lies on something cannot give way into it; its impulse goes there with the next small
    // step.
    const bool blocked = points.contacts[v].count > 0 && points.solver->touching(pair.v[k]) &&
                         gap.weights[k] * normal.dot(points.contacts[v].planes[0].normal) < 0.0;
    position_mass[k] = blocked ? 0.0 : inverse;
    give += gap.weights[k] * gap.weights[k] * inverse;
    give_position += gap.weights[k] * gap.weights[k] * position_mass[k];
    velocity += gap.weights[k] * points.velocities[v];
  }
  if (!(give > 0.0)) {
    return false;
  }
  if (give_position <= 1e-6 * give) {  // between what cannot move: the rest shares it
    give_position = give;
    std::copy(std::begin(speed_masses), std::end(speed_masses), std::begin(position_mass));
  }
  const double approach = -normal.dot(velocity);
  Vec3 impulse = Vec3::Zero();
  if (approach > 0.0) {
    impulse = approach / give * normal;
    const Vec3 slip = velocity + approach * normal;
    const double speed = slip.norm(), most = friction * approach;
    impulse -= (speed > most ? most / speed : 1.0) / give * slip;
  }
  for (int k = 0; k < 4; ++k) {
    const auto v = static_cast<std::size_t>(pair.v[k]);
    points.positions[v] += gap.weights[k] * position_mass[k] * missing / give_position * normal;
    points.velocities[v] += gap.weights[k] * speed_masses[k] * impulse;
  }
  return true;
}

bool SelfContactPass::correct(const Points& points, double friction) {
  const double moved = spread(points.positions, points.before);
  const bool may_search = counts.searches < kMostSearches;
  if (!known_ || (may_search && spread(points.positions, searched_at_) >= 0.5 * (reach_ - thickness_))) {
    // Of this small step alone: all that can meet within it has to be found, where it began.
    // Beyond two rooms every face has every neighbour near: violent motion may miss some.
    reach_ = thickness_ + std::clamp(2.5 * moved, room_, 2.0 * room_);
    search(points.before);
  }
  if (pairs_.empty()) {
    return false;
  }
  travel_ += 2.1 * moved;
  bool changed = false;
  for (int round = 0; round < kRounds; ++round) {
    bool corrected = false;
    for (Pair& pair : pairs_) {
      if (pair.due > travel_) {
        continue;
      }
      const Gap gap = gap_of(pair, points.positions);
      if (!gap.within) {
        pair.side = 0;
      } else if (pair.side == 0) {
        choose_side(pair, gap, points);
      }
      const double height = pair.side == 0 ? std::abs(gap.height) : pair.side * gap.height;
      // Corrections may bring others nearer by themselves: some room for those.
      pair.due = gap.height < 1e29 ? travel_ + height - 2.0 * thickness_ : travel_;
      if (gap.within && height < thickness_) {
        corrected |= separate(pair, gap, points, friction);
        ++counts.contacts;
      }
    }
    if (!corrected) {
      break;
    }
    changed = true;
  }
  return changed;
}

void SelfContactPass::archive(StateArchive& archive, int points) {
  archive.flag("self.known", known_);
  archive.number("self.reach", reach_, 0.0);
  archive.vectors("self.searched_at", searched_at_);
  archive.number("self.travel", travel_, 0.0);
  archive.list("self.pairs", pairs_, 1'000'000'000LL, [&](Pair& pair) {
    for (int& v : pair.v) {
      archive.integer("self.point", v, 0, points - 1);
    }
    archive.flag("self.edges", pair.edges);
    int side = pair.side;
    archive.integer("self.side", side, -1, 1);
    pair.side = static_cast<signed char>(side);
    archive.number("self.due", pair.due);
  });
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

#include "self_contact.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// Pairs a point that a search finds at most; what is left out is counted (Counts::dropped).
constexpr std::size_t kMostPairs = 48;
// Of the spacing: how far points move before near pairs are looked for anew.
constexpr double kRoom = 0.3;
// Of that: what points may move against each other within a small step; the rest of the way they lose.
constexpr double kMostRooms = 4;
// Rounds of corrections after a small step.
constexpr int kRounds = 6;
// Of the thickness: what a pair that is too near is taken apart by in a small step. At once would be a blow.
constexpr double kRecovery = 0.02;
// m; smaller motions are taken as they are.
constexpr double kWorthFitting = 2e-4;

}  // namespace

SelfContactPass::SelfContactPass(const ClothPattern& pattern, double thickness)
    : patches_(pattern),
      zones_(pattern.points.size()),
      thickness_(thickness),
      room_(kRoom * pattern.spacing) {
  searched_at_.assign(pattern.points.size(), Vec3::Zero());
  wanted_.assign(pattern.points.size(), Vec3::Zero());
  most_pairs_ = kMostPairs * pattern.points.size();
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
  double most[4] = {0, 0, 0, 0};  // four at a time: one after the other, each maximum would wait for the last
  for (std::size_t v = 0; v < count; ++v) {
    const double square = (to[v] - from[v] - shared).squaredNorm();
    most[v % 4] = square > most[v % 4] ? square : most[v % 4];
  }
  const double farthest = *std::max_element(most, most + 4);
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

bool SelfContactPass::outrun(std::span<const Vec3> positions) const {
  return !known_ || spread(positions, searched_at_) >= 0.5 * reach_ - 1.5 * thickness_;
}

// The pairs that may touch while points go `way` (m) against each other, as they are at the start of the
// small step.
void SelfContactPass::activate(std::span<const Vec3> before, double way) {
  const double limit = travel_ + way;
  for (Pair& pair : pairs_) {
    if (pair.due > limit) {
      continue;
    }
    Vec3 x[4];
    pair.corners(before, x);
    SelfMeeting meeting;
    meeting.pair = pair;
    meeting.nearest = nearest_of(pair.edges, x);
    const double distance = meeting.nearest.distance;
    pair.due = travel_ + distance - 2.0 * thickness_;
    if (pair.due > limit || !(distance > 0.0)) {
      continue;
    }
    pair.due = HUGE_VAL;  // not twice in this small step
    meeting.normal = meeting.nearest.apart / distance;
    meeting.thickness = thickness_;
    meeting.wanted = std::min(thickness_, distance + kRecovery * thickness_);
    meetings_.push_back(meeting);
  }
}

// Takes two apart and stops their approach, with friction.
bool SelfContactPass::push_apart(const SelfMeeting& meeting, const Points& points, double friction) {
  Vec3 x[4];
  meeting.pair.corners(points.positions, x);
  const double* weights = meeting.nearest.weights;
  const Vec3& normal = meeting.normal;
  const double missing = meeting.wanted - meeting.nearest.gap(x, normal);
  if (!(missing > 1e-3 * thickness_)) {
    return false;
  }
  double give = 0, give_position = 0, position_mass[4], speed_mass[4];
  Vec3 velocity = Vec3::Zero();
  for (int k = 0; k < 4; ++k) {
    const auto v = static_cast<std::size_t>(meeting.pair.v[k]);
    speed_mass[k] = points.inverse_masses[v];
    // A point cannot give way into what it lies on; its impulse goes there with the next small step.
    bool blocked = false;
    for (int c = 0; c < points.contacts[v].count && !blocked; ++c) {
      const ContactPlane& plane = points.contacts[v].planes[c];
      blocked = weights[k] * normal.dot(plane.normal) < 0.0 &&
                plane.normal.dot(x[k] - plane.foot - points.h * plane.velocity) < thickness_;
    }
    position_mass[k] = blocked ? 0.0 : speed_mass[k];
    give += weights[k] * weights[k] * speed_mass[k];
    give_position += weights[k] * weights[k] * position_mass[k];
    velocity += weights[k] * points.velocities[v];
  }
  if (!(give > 0.0)) {
    return false;
  }
  const double approach = -normal.dot(velocity);
  Vec3 impulse = Vec3::Zero();
  if (approach > 0.0) {
    impulse = approach / give * normal;
    const Vec3 slip = velocity + approach * normal;
    const double speed = slip.norm(), most = friction * approach;
    impulse -= (speed > most ? most / speed : 1.0) / give * slip;
  }
  const double by = give_position > 1e-6 * give ? missing / give_position : 0.0;
  for (int k = 0; k < 4; ++k) {
    const auto v = static_cast<std::size_t>(meeting.pair.v[k]);
    points.positions[v] += weights[k] * position_mass[k] * by * normal;
    points.velocities[v] += weights[k] * speed_mass[k] * impulse;
  }
  return true;
}

bool SelfContactPass::push_apart(const Points& points, double friction) {
  bool changed = false;
  for (int round = 0; round < kRounds; ++round) {
    bool corrected = false;
    for (const SelfMeeting& meeting : meetings_) {
      const bool pushed = push_apart(meeting, points, friction);
      counts.contacts += pushed;
      corrected |= pushed;
    }
    if (!corrected) {
      break;
    }
    changed = true;
  }
  return changed;
}

// No point goes farther than `most` (m) against the mean of all.
void SelfContactPass::slow_down(const Points& points, double most) {
  Vec3 mean = Vec3::Zero();
  for (std::size_t v = 0; v < points.before.size(); ++v) {
    mean += points.positions[v] - points.before[v];
  }
  mean /= static_cast<double>(points.before.size());
  for (std::size_t v = 0; v < points.before.size(); ++v) {
    const Vec3 own = points.positions[v] - points.before[v] - mean;
    const double size = own.norm();
    if (size > most && points.inverse_masses[v] > 0.0) {
      const Vec3 lost = (1.0 - most / size) * own;
      points.positions[v] -= lost;
      points.velocities[v] -= lost / points.h;
    }
  }
}

bool SelfContactPass::correct(const Points& points, double friction) {
  double moved = spread(points.positions, points.before);
  const bool slowed = moved > 0.4 * kMostRooms * room_;
  if (slowed) {
    slow_down(points, 0.4 * kMostRooms * room_);
    moved = 0.4 * kMostRooms * room_;
  }
  if (outrun(points.positions)) {
    // All that can meet within this small step has to be found, where it began.
    reach_ = 3.0 * thickness_ + std::clamp(2.5 * moved, room_, kMostRooms * room_);
    search(points.before);
  }
  if (pairs_.empty()) {
    return slowed;
  }
  meetings_.clear();
  activate(points.before, 2.0 * moved);
  travel_ += 2.0 * moved;
  if (meetings_.empty()) {
    return slowed;
  }
  std::copy(points.positions.begin(), points.positions.end(), wanted_.begin());
  const bool pushed = push_apart(points, friction);
  // Farther, and pairs that nobody looked at could meet.
  for (std::size_t v = 0; v < wanted_.size() && pushed; ++v) {
    const Vec3 by = points.positions[v] - wanted_[v];
    const double size = by.norm();
    if (size > thickness_) {
      points.positions[v] = wanted_[v] + thickness_ / size * by;
    }
  }
  const SelfZones::Motion motion{points.positions, points.velocities, points.inverse_masses,
                                 points.before,    points.contacts,   points.h};
  const int joined = zones_.join(motion, meetings_);
  counts.zones += joined;
  double farthest = 0;
  for (std::size_t v = 0; v < wanted_.size(); ++v) {
    farthest = std::max(farthest, (points.positions[v] - wanted_[v]).squaredNorm());
  }
  travel_ += 2.0 * std::sqrt(farthest);
  for (Pair& pair : pairs_) {
    if (pair.due == HUGE_VAL) {
      pair.due = travel_;  // to be looked at in the next one
    }
  }
  return slowed || pushed || joined > 0;
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
    archive.number("self.due", pair.due);
  });
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

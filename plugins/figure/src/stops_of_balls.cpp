// Where joints stand against their ranges, in one number a range: a joint's own, or what (28) to (31) of
// doc/dynamics.md make of a ball's turn.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "stops_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kOnTheStop = 1e-14;  // rad, and of the fastest joint's rate

}  // namespace

double FigureStepper::Impl::place_of(const Limited& joint, const FigureState& at) const {
  const double* q = at.q.data() + joint.q;
  if (joint.part == Limited::Part::kNumber) return *q;
  const BallRange& range = ball_ranges[static_cast<std::size_t>(joint.ball)];
  const BallRange::Turn turn = range.turn(q);
  const double place = joint.part == Limited::Part::kSwing ? range.excess(turn) : turn.twist;
  for (const double bound : {joint.lower, joint.upper}) {
    if (std::abs(place - bound) <= kOnTheStop) return bound;
  }
  return place;
}

double FigureStepper::Impl::next_place(const Limited& joint) const {
  const double place = place_of(joint, next);
  if (joint.part != Limited::Part::kTwist) return place;
  const double gone = place - place_of(joint, state);
  if (gone > std::numbers::pi) return place - 2 * std::numbers::pi;
  return gone < -std::numbers::pi ? place + 2 * std::numbers::pi : place;
}

BallRange::Row FigureStepper::Impl::row_of(const Limited& joint, const FigureState& at) const {
  const BallRange& range = ball_ranges[static_cast<std::size_t>(joint.ball)];
  const BallRange::Turn turn = range.turn(at.q.data() + joint.q);
  const Vec3 spin = Eigen::Map<const Vec3>(at.qd.data() + joint.v);
  return joint.part == Limited::Part::kSwing ? range.swing_row(turn, spin) : range.twist_row(turn, spin);
}

double FigureStepper::Impl::rate_of(const Limited& joint, const FigureState& at) const {
  const double* qd = at.qd.data() + joint.v;
  if (joint.part == Limited::Part::kNumber) return *qd;
  const double rate = row_of(joint, at).gradient.dot(Eigen::Map<const Vec3>(qd));
  double fastest = 0;
  for (const double v : at.qd) fastest = std::max(fastest, std::abs(v));
  return std::abs(rate) <= kOnTheStop * fastest ? 0 : rate;
}

void FigureStepper::Impl::put(const Limited& joint, double bound, FigureState& at) const {
  double* q = at.q.data() + joint.q;
  if (joint.part == Limited::Part::kNumber) {
    *q = bound;
    return;
  }
  const BallRange& range = ball_ranges[static_cast<std::size_t>(joint.ball)];
  BallRange::Turn turn = range.turn(q);
  if (joint.part == Limited::Part::kSwing) {
    turn = range.on_cone(turn);
  } else {
    turn.twist = bound;
  }
  range.set(turn, q);
}

void FigureStepper::Impl::calm(const Limited& joint, FigureState& at) const {
  double* qd = at.qd.data() + joint.v;
  if (joint.part == Limited::Part::kNumber) {
    *qd = 0;
    return;
  }
  const Vec3 gradient = row_of(joint, at).gradient;
  Eigen::Map<Vec3> spin(qd);
  spin -= gradient * (gradient.dot(spin) / gradient.squaredNorm());
}

double FigureStepper::Impl::pull_of(std::size_t i) const {
  return limited[i].part == Limited::Part::kNumber ? torque[static_cast<std::size_t>(limited[i].v)]
                                                   : ball_pulls[i];
}

void FigureStepper::Impl::look_at_balls(const FigureState& at) {
  if (ball_ranges.empty()) return;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    if (limited[i].part != Limited::Part::kNumber) seen[i] = row_of(limited[i], at);
  }
}

double FigureStepper::Impl::gain_of(std::size_t i, bool with_bias) const {
  const double* a = acceleration.data() + limited[i].v;
  if (limited[i].part == Limited::Part::kNumber) return *a;
  return seen[i].gradient.dot(Eigen::Map<const Vec3>(a)) + (with_bias ? seen[i].bias : 0);
}

double FigureStepper::Impl::longest_part() const {
  double longest = 1e9;
  for (const Limited& joint : limited) {
    if (joint.part != Limited::Part::kSwing || !chosen[static_cast<std::size_t>(joint.link)]) continue;
    const double spin = Eigen::Map<const Vec3>(state.qd.data() + joint.v).norm();
    const double far = ball_ranges[static_cast<std::size_t>(joint.ball)].farthest();
    if (spin * longest > far) longest = far / spin;
  }
  return longest;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

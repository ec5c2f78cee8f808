#include "ball_range.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kShareOfCone = 0.2;  // rows of a cone turn with the ball: in a part of a step, by no more

Mat3 frame_of(const Link& link) {
  Mat3 frame;
  frame << link.swing_axis, link.axis.cross(link.swing_axis), link.axis;
  return frame;
}

// Of the angle t with z = t^2: f = (t / sin t - 1) / z and h = tan(t / 2) / t, with derivatives by z.
struct SwingSeries {
  double f, df, h, dh;
  explicit SwingSeries(double z) {
    if (z < 1e-2) {
      f = 1.0 / 6 + z * (7.0 / 360 + z * (31.0 / 15120 + z * (127.0 / 604800 + z * (73.0 / 3421440))));
      df = 7.0 / 360 + z * (31.0 / 7560 + z * (127.0 / 201600 + z * (73.0 / 855360)));
      h = 0.5 + z * (1.0 / 24 + z * (1.0 / 240 + z * (17.0 / 40320 + z * (31.0 / 725760))));
      dh = 1.0 / 24 + z * (1.0 / 120 + z * (17.0 / 13440 + z * (31.0 / 181440)));
      return;
    }
    const double t = std::sqrt(z), s = std::sin(t), c = std::cos(0.5 * t);
    f = (t / s - 1) / z;
    df = ((s - t * std::cos(t)) / (2 * t * s * s) - f) / z;
    h = std::tan(0.5 * t) / t;
    dh = (0.5 / (c * c) - h) / (2 * z);
  }
};

// How swing and twist move: their rates, and k = spin . (axis x swing), all with what they gain at a constant
// spin.
struct SwingRates {
  double x, y, twist, k;        // rates; k itself
  double a, b, a_rate, b_rate;  // the spin across the axis, turned by the twist
  double k_rate;
  SwingRates(const BallRange::Turn& at, const SwingSeries& series, const Vec3& spin) {
    const double c = std::cos(at.twist), s = std::sin(at.twist);
    a = c * spin.x() - s * spin.y();
    b = s * spin.x() + c * spin.y();
    k = at.x * b - at.y * a;
    x = a - series.f * k * at.y;
    y = b + series.f * k * at.x;
    twist = spin.z() + series.h * k;
    a_rate = -twist * b;
    b_rate = twist * a;
    k_rate = x * b + at.x * b_rate - y * a - at.y * a_rate;
  }
};

// (a, b) = twist turned spin: the gradient's way back.
Vec3 turned_back(const BallRange::Turn& at, double a, double b, double along) {
  const double c = std::cos(at.twist), s = std::sin(at.twist);
  return {c * a + s * b, c * b - s * a, along};
}

}  // namespace

BallRange::BallRange(const Link& link)
    : frame_(frame_of(link)),
      about_(1 / (link.swing_about * link.swing_about)),
      across_(1 / (link.swing_across * link.swing_across)),
      size_(std::min(link.swing_about, link.swing_across)),
      middle_(link.lower > -1e9 ? 0.5 * (link.lower + link.upper) : 0),
      farthest_(std::min(0.5 * (std::numbers::pi - std::max(link.swing_about, link.swing_across)),
                         kShareOfCone * size_)) {}

BallRange::Turn BallRange::turn(const double* q) const {
  const Vec3 v = frame_.transpose() * Vec3(q[1], q[2], q[3]);
  const double side = q[0] < 0 ? -1 : 1, w = std::abs(q[0]), z = side * v.z();
  const double along = std::hypot(w, z);  // cos of half the swing
  const double c = along > 0 ? w / along : 1, s = along > 0 ? z / along : 0;
  const double x = side * (c * v.x() - s * v.y()), y = side * (c * v.y() + s * v.x());
  const double across = std::hypot(x, y);  // sin of it
  const double scale = across > 1e-8 ? 2 * std::atan2(across, along) / across : 2;
  double twist = 2 * std::atan2(z, w);
  if (twist - middle_ > std::numbers::pi) twist -= 2 * std::numbers::pi;
  if (twist - middle_ < -std::numbers::pi) twist += 2 * std::numbers::pi;
  return {scale * x, scale * y, twist};
}

void BallRange::set(const Turn& turn, double* q) const {
  const double angle = std::hypot(turn.x, turn.y);
  const double scale = angle > 1e-8 ? std::sin(0.5 * angle) / angle : 0.5;
  const double c = std::cos(0.5 * turn.twist), s = std::sin(0.5 * turn.twist), w = std::cos(0.5 * angle);
  const double x = scale * turn.x, y = scale * turn.y;
  const Vec3 v = frame_ * Vec3(c * x + s * y, c * y - s * x, w * s);
  q[0] = w * c;
  for (int k = 0; k < 3; ++k) q[k + 1] = v[k];
}

double BallRange::excess(const Turn& at) const {
  return 0.5 * size_ * (about_ * at.x * at.x + across_ * at.y * at.y - 1);
}

BallRange::Turn BallRange::on_cone(Turn at) const {
  const double scale = 1 / std::sqrt(about_ * at.x * at.x + across_ * at.y * at.y);
  at.x *= scale;
  at.y *= scale;
  return at;
}

BallRange::Row BallRange::swing_row(const Turn& at, const Vec3& spin) const {
  const SwingSeries series(at.x * at.x + at.y * at.y);
  const SwingRates r(at, series, frame_.transpose() * spin);
  const double p = about_ * at.x, q = across_ * at.y, e = at.x * q - at.y * p;
  const double e_rate = (across_ - about_) * (r.x * at.y + at.x * r.y);
  const double f_rate = 2 * series.df * (at.x * r.x + at.y * r.y);
  const double fe = series.f * e;
  return {size_ * (frame_ * turned_back(at, p - fe * at.y, q + fe * at.x, 0)),
          size_ * (about_ * r.x * r.a + across_ * r.y * r.b + p * r.a_rate + q * r.b_rate + f_rate * r.k * e +
                   series.f * (r.k_rate * e + r.k * e_rate))};
}

BallRange::Row BallRange::twist_row(const Turn& at, const Vec3& spin) const {
  const SwingSeries series(at.x * at.x + at.y * at.y);
  const SwingRates r(at, series, frame_.transpose() * spin);
  return {frame_ * turned_back(at, -series.h * at.y, series.h * at.x, 1),
          2 * series.dh * (at.x * r.x + at.y * r.y) * r.k + series.h * r.k_rate};
}

SwingTwist swing_twist(const Link& link, const double* q) {
  Link unlimited = link;
  open_range(unlimited);
  const BallRange range(unlimited);
  const BallRange::Turn turn = range.turn(q);
  return {range.swing(turn), turn.twist};
}

void set_swing_twist(const Link& link, const SwingTwist& turn, double* q) {
  BallRange(link).set(
      {turn.swing.dot(link.swing_axis), turn.swing.dot(link.axis.cross(link.swing_axis)), turn.twist}, q);
}

bool has_range(const Link& link) {
  switch (link.joint) {
    case JointKind::kHinge:
    case JointKind::kPrismatic:
      return link.lower > -1e9 || link.upper < 1e9;
    case JointKind::kBall:
      return link.swing_about < 1e9;
    default:
      return false;
  }
}

double outside_range(const Link& link, const double* q) {
  if (!has_range(link)) return 0;
  if (link.joint != JointKind::kBall) return std::max({0.0, *q - link.upper, link.lower - *q});
  const BallRange range(link);
  const BallRange::Turn turn = range.turn(q);
  return std::max({0.0, range.excess(turn), turn.twist - link.upper, link.lower - turn.twist});
}

void put_inside(const Link& link, double* q) {
  if (!has_range(link)) return;
  if (link.joint != JointKind::kBall) {
    *q = std::clamp(*q, link.lower, link.upper);
    return;
  }
  if (outside_range(link, q) == 0) return;
  const BallRange range(link);
  BallRange::Turn turn = range.turn(q);
  if (range.excess(turn) > 0) turn = range.on_cone(turn);
  turn.twist = std::clamp(turn.twist, link.lower, link.upper);
  range.set(turn, q);
}

void open_range(Link& link) {
  link.swing_about = link.swing_across = 1e9;
  link.lower = -1e9;
  link.upper = 1e9;
}

void widen_range(Link& link, const double* q) {
  if (outside_range(link, q) == 0) return;
  if (link.joint != JointKind::kBall) {
    link.lower = std::min(link.lower, *q);
    link.upper = std::max(link.upper, *q);
    return;
  }
  const BallRange range(link);
  const BallRange::Turn turn = range.turn(q);
  const double angle = range.swing(turn).norm();
  const double wider = range.excess(turn) > 0 ? angle / range.swing(range.on_cone(turn)).norm() : 1;
  const double about = link.swing_about * wider, across = link.swing_across * wider;
  if (std::max(about, across) > kMostSwing || std::abs(turn.twist) > kMostTwist) {
    open_range(link);
    return;
  }
  link.swing_about = about;
  link.swing_across = across;
  link.lower = std::min(link.lower, turn.twist);
  link.upper = std::max(link.upper, turn.twist);
}

double outside_ranges(const FigureModel& model, const FigureState& state) {
  double worst = 0;
  for (int i = 0; i < model.link_count(); ++i) {
    worst = std::max(worst, outside_range(model.links()[static_cast<std::size_t>(i)],
                                          state.q.data() + model.position_offset(i)));
  }
  return worst;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

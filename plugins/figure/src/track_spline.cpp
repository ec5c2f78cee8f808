// Splines of joints. A segment runs from x0 by increments w_i that cumulative Bernstein polynomials b_i bring
// in: x = x0 + sum b_i w_i, and for turns R = R0 exp(b_1 w_1) exp(b_2 w_2) ..., whose spins at the ends are
// n w_1 / h and n w_n / h as those of the sum.
#include <algorithm>
#include <cmath>

#include "bernstein.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/keyframes.h"
#include "turn_vector.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

using Eigen::Quaterniond;

Vec3 vec3_from(const double* x) { return {x[0], x[1], x[2]}; }
void put_three(const Vec3& x, double* to) { std::copy_n(x.data(), 3, to); }
Quaterniond quaternion_from(const double* x) { return {x[0], x[1], x[2], x[3]}; }

// A key's three numbers of one kind, slid or turned, as the construction wants them.
struct Knot {
  double time = 0;
  Vec3 slide = Vec3::Zero();
  Quaterniond turn = Quaterniond::Identity();
  bool given = false;
  Vec3 rate = Vec3::Zero(), acceleration = Vec3::Zero();
};

Vec3 difference(bool turns, const Knot& a, const Knot& b) {
  return turns ? vector_of(a.turn.conjugate() * b.turn) : Vec3(b.slide - a.slide);
}

// The middle increment of a cubic whose ends have the given rates.
Vec3 middle(bool turns, const Knot& a, const Knot& b) {
  const double h = b.time - a.time;
  const Vec3 first = h / 3 * a.rate, last = h / 3 * b.rate;
  if (!turns) return b.slide - a.slide - first - last;
  return vector_of(turn_of(-first) * (a.turn.conjugate() * b.turn) * turn_of(-last));
}

// Rate at a key from the parabola through it and its neighbours.
Vec3 parabola_rate(bool turns, const Knot& a, const Knot& b, const Knot& c) {
  const double h = b.time - a.time, k = c.time - b.time;
  return (k / h * difference(turns, a, b) + h / k * difference(turns, b, c)) / (h + k);
}

void limit_monotone(std::vector<Knot>& knots) {
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const double h = knots[i + 1].time - knots[i].time;
    for (int k = 0; k < 3; ++k) {
      const double slope = (knots[i + 1].slide[k] - knots[i].slide[k]) / h;
      double &a = knots[i].rate[k], &b = knots[i + 1].rate[k];
      if (!knots[i].given && a * slope <= 0) a = 0;
      if (!knots[i + 1].given && b * slope <= 0) b = 0;
      const double size = std::hypot(a, b);
      if (size <= 3 * std::abs(slope)) continue;
      if (!knots[i].given) a *= 3 * std::abs(slope) / size;
      if (!knots[i + 1].given) b *= 3 * std::abs(slope) / size;
    }
  }
}

// Rates at which accelerations meet, by Gauss and Seidel: the diagonal is twice what stands beside it.
void meet_accelerations(bool turns, std::vector<Knot>& knots, bool runs_on) {
  for (int sweep = 0; sweep < 60; ++sweep) {
    for (std::size_t i = 1; i + 1 < knots.size(); ++i) {
      if (knots[i].given) continue;
      const double h = knots[i].time - knots[i - 1].time, k = knots[i + 1].time - knots[i].time;
      Vec3 before = middle(turns, knots[i - 1], knots[i]);
      if (turns) before = turn_of(-h / 3 * knots[i].rate) * before;
      const Vec3 after = middle(turns, knots[i], knots[i + 1]);
      knots[i].rate =
          (6 / (k * k) * after + 6 / (h * h) * before + (2 / h + 2 / k) * knots[i].rate) / (4 / h + 4 / k);
    }
    if (runs_on && !knots.back().given && knots.size() > 1) {  // no acceleration at the end
      const Knot& a = knots[knots.size() - 2];
      Knot& b = knots.back();
      b.rate = (1.5 * difference(turns, a, b) / (b.time - a.time) - 0.5 * a.rate).eval();
    }
  }
}

void choose_rates(Interpolation kind, bool turns, bool runs_on, std::vector<Knot>& knots) {
  const std::size_t last = knots.size() - 1;
  if (kind == Interpolation::kQuadratic) {  // a rate given beside the first is not met
    for (std::size_t i = 0; i < last; ++i) {
      const Vec3 mean = difference(turns, knots[i], knots[i + 1]) / (knots[i + 1].time - knots[i].time);
      knots[i + 1].rate = 2 * mean - knots[i].rate;
    }
    return;
  }
  for (std::size_t i = 1; i < last; ++i) {
    if (!knots[i].given) knots[i].rate = parabola_rate(turns, knots[i - 1], knots[i], knots[i + 1]);
  }
  if (runs_on && last > 0 && !knots[last].given) {
    const Vec3 mean =
        difference(turns, knots[last - 1], knots[last]) / (knots[last].time - knots[last - 1].time);
    knots[last].rate = 1.5 * mean - 0.5 * knots[last - 1].rate;
  }
  if (kind == Interpolation::kMonotone && !turns) limit_monotone(knots);
  if (kind == Interpolation::kSmooth) meet_accelerations(turns, knots, runs_on);
  if (kind == Interpolation::kQuintic) {
    for (std::size_t i = 1; i < last; ++i) {
      const double h = knots[i].time - knots[i - 1].time, k = knots[i + 1].time - knots[i].time;
      knots[i].acceleration =
          2 / (h + k) *
          (difference(turns, knots[i], knots[i + 1]) / k - difference(turns, knots[i - 1], knots[i]) / h);
    }
  }
}

// Increments of a segment.
void join(Interpolation kind, bool turns, const Knot& a, const Knot& b, double (*w)[3]) {
  const double h = b.time - a.time;
  if (kind == Interpolation::kQuadratic) {
    const Vec3 first = h / 2 * a.rate;
    const Vec3 rest =
        turns ? vector_of(turn_of(-first) * (a.turn.conjugate() * b.turn)) : Vec3(b.slide - a.slide - first);
    put_three(first, w[0]);
    put_three(rest, w[1]);
    return;
  }
  if (kind != Interpolation::kQuintic) {
    put_three(h / 3 * a.rate, w[0]);
    put_three(middle(turns, a, b), w[1]);
    put_three(h / 3 * b.rate, w[2]);
    return;
  }
  const Vec3 first = h / 5 * a.rate, second = first + h * h / 20 * a.acceleration, fifth = h / 5 * b.rate;
  Vec3 fourth = fifth - h * h / 20 * b.acceleration;
  if (turns) fourth = turn_of(fifth) * fourth;
  put_three(first, w[0]);
  put_three(second, w[1]);
  put_three(turns ? vector_of(turn_of(-second) * turn_of(-first) * (a.turn.conjugate() * b.turn) *
                              turn_of(-fifth) * turn_of(-fourth))
                  : Vec3(b.slide - a.slide - first - second - fourth - fifth),
            w[2]);
  put_three(fourth, w[3]);
  put_three(fifth, w[4]);
}

}  // namespace

TrackSpline::TrackSpline(const FigureModel& model, const JointTrack& track, bool runs_on)
    : TrackSpline(model, track, {}, runs_on) {}

TrackSpline::TrackSpline(const FigureModel& model, const JointTrack& track,
                         const std::vector<double>& acceleration, bool runs_on)
    : kind_(model.links()[static_cast<std::size_t>(track.link)].joint),
      turns_(kind_ == JointKind::kBall || kind_ == JointKind::kFree),
      first_(track.keys.front()) {
  slides_ = kind_ == JointKind::kFree ? 3 : turns_ || kind_ == JointKind::kFixed ? 0 : 1;
  build(track, acceleration, runs_on);
}

void TrackSpline::build(const JointTrack& track, const std::vector<double>& acceleration, bool runs_on) {
  const Interpolation kind = track.interpolation;
  degree_ = kind == Interpolation::kQuadratic ? 2 : kind == Interpolation::kQuintic ? 5 : 3;
  const std::size_t count = track.keys.size();
  segments_.resize(count - 1);
  const int turn_q = slides_ == 3 ? 3 : 0;  // a free joint has its place first
  for (const bool turns : {false, true}) {
    if (turns ? !turns_ : slides_ == 0) continue;
    std::vector<Knot> knots(count);
    for (std::size_t i = 0; i < count; ++i) {
      const JointKey& key = track.keys[i];
      Knot& knot = knots[i];
      knot.time = key.time;
      knot.given = !key.qd.empty();
      if (turns) {
        knot.turn = quaternion_from(key.q.data() + turn_q);
      } else {
        for (int k = 0; k < slides_; ++k) knot.slide[k] = key.q[static_cast<std::size_t>(k)];
      }
      // Where a joint's rates stand: a free joint's spin comes first and goes by the world's axes.
      const auto take = [&](const std::vector<double>& from) {
        Vec3 rate = Vec3::Zero();
        if (turns) {
          rate = vec3_from(from.data());
          if (slides_ == 3) rate = knot.turn.conjugate() * rate;
        } else {
          for (int k = 0; k < slides_; ++k)
            rate[k] = from[static_cast<std::size_t>(slides_ == 3 ? 3 + k : k)];
        }
        return rate;
      };
      if (knot.given) knot.rate = take(key.qd);
      if (i == 0 && !acceleration.empty()) knot.acceleration = take(acceleration);
    }
    choose_rates(kind, turns, runs_on, knots);
    for (std::size_t i = 0; i + 1 < count; ++i) {
      Segment& s = segments_[i];
      s.begin = knots[i].time;
      s.end = knots[i + 1].time;
      if (turns) {
        const Quaterniond& r = knots[i].turn;
        s.turn[0] = r.w();
        put_three(r.vec(), s.turn + 1);
      } else {
        put_three(knots[i].slide, s.slide);
      }
      join(kind, turns, knots[i], knots[i + 1], turns ? s.turns : s.slides);
    }
  }
}

void TrackSpline::evaluate(double time, double* q, double* qd, double* qdd) const {
  const int rates = velocity_count(kind_);
  if (segments_.empty() || time < segments_.front().begin) {
    std::copy(first_.q.begin(), first_.q.end(), q);
    std::fill_n(qd, rates, 0.0);
    std::fill_n(qdd, rates, 0.0);
    return;
  }
  auto it = std::upper_bound(segments_.begin(), segments_.end(), time,
                             [](double t, const Segment& s) { return t < s.begin; });
  const Segment& s = *(it - 1);
  const double h = s.end - s.begin, u = std::min(1.0, (time - s.begin) / h);
  const double moving = time > s.end ? 0 : 1;  // after the last key
  const BernsteinWeights w = bernstein_weights(degree_, u);
  const int v = slides_ == 3 ? 3 : 0;
  for (int k = 0; k < slides_; ++k) {
    double x = s.slide[k], first = 0, second = 0;
    for (int i = 0; i < degree_; ++i) {
      x += w.value[i] * s.slides[i][k];
      first += w.first[i] * s.slides[i][k];
      second += w.second[i] * s.slides[i][k];
    }
    q[k] = x;
    qd[v + k] = moving * first / h;
    qdd[v + k] = moving * second / (h * h);
  }
  if (!turns_) return;
  Quaterniond turn = quaternion_from(s.turn);
  Vec3 spin = Vec3::Zero(), gain = Vec3::Zero();
  for (int i = 0; i < degree_; ++i) {
    const Vec3 d = vec3_from(s.turns[i]);
    const Quaterniond step = turn_of(w.value[i] * d);
    const Vec3 own = w.first[i] * d;
    turn = turn * step;
    spin = step.conjugate() * spin;
    gain = step.conjugate() * gain + spin.cross(own) + w.second[i] * d;
    spin += own;
  }
  turn.normalize();
  spin *= moving / h;
  gain *= moving / (h * h);
  if (slides_ == 3) {  // world axes
    spin = turn * spin;
    gain = turn * gain;
    q += 3;
  }
  q[0] = turn.w();
  put_three(turn.vec(), q + 1);
  put_three(spin, qd);
  put_three(gain, qdd);
}

void TrackSpline::append_numbers(double begin, double end, std::vector<double>& to) const {
  to.insert(to.end(), first_.q.begin(), first_.q.end());
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const Segment& s = segments_[i];
    const bool last = i + 1 == segments_.size();  // it is where the joint stands from then on
    if ((s.end < begin && !last) || s.begin > end) continue;
    to.push_back(s.begin);
    to.push_back(s.end);
    if (slides_ > 0) {
      to.insert(to.end(), s.slide, s.slide + slides_);
      for (int k = 0; k < degree_; ++k) to.insert(to.end(), s.slides[k], s.slides[k] + slides_);
    }
    if (turns_) {
      to.insert(to.end(), s.turn, s.turn + 4);
      for (int k = 0; k < degree_; ++k) to.insert(to.end(), s.turns[k], s.turns[k] + 3);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

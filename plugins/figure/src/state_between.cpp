#include "state_between.h"

#include "turn_vector.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

using Eigen::Quaterniond;

struct Cubic {
  double h, value[3], slope[3];  // cumulative Bernstein polynomials and derivatives by u
  Cubic(double span, double u)
      : h(span),
        value{1 - (1 - u) * (1 - u) * (1 - u), u * u * (3 - 2 * u), u * u * u},
        slope{3 * (1 - u) * (1 - u), 6 * u * (1 - u), 3 * u * u} {}
};

void slide(const Cubic& c, double x0, double v0, double x1, double v1, double& x, double& v) {
  const double w[3] = {c.h / 3 * v0, x1 - x0 - c.h / 3 * (v0 + v1), c.h / 3 * v1};
  x = x0;
  v = 0;
  for (int k = 0; k < 3; ++k) {
    x += c.value[k] * w[k];
    v += c.slope[k] * w[k] / c.h;
  }
}

// Spins in the turned axes.
void turn(const Cubic& c, const Quaterniond& r0, const Vec3& s0, const Quaterniond& r1, const Vec3& s1,
          Quaterniond& r, Vec3& s) {
  const Vec3 first = c.h / 3 * s0, last = c.h / 3 * s1;
  const Vec3 w[3] = {first, vector_of(turn_of(-first) * (r0.conjugate() * r1) * turn_of(-last)), last};
  r = r0;
  s.setZero();
  for (int k = 0; k < 3; ++k) {
    const Quaterniond step = turn_of(c.value[k] * w[k]);
    r = r * step;
    s = step.conjugate() * s + c.slope[k] / c.h * w[k];
  }
  r.normalize();
}

Quaterniond quaternion_at(const std::vector<double>& q, int at) {
  const double* x = q.data() + at;
  return {x[0], x[1], x[2], x[3]};
}
Vec3 three_at(const std::vector<double>& x, int at) { return Eigen::Map<const Vec3>(x.data() + at); }

}  // namespace

void state_between(const FigureModel& model, const FigureState& from, const FigureState& until, double h,
                   double u, FigureState& to) {
  to.q.resize(from.q.size());
  to.qd.resize(from.qd.size());
  const Cubic c(h, u);
  for (int i = 0; i < model.link_count(); ++i) {
    const JointKind kind = model.links()[static_cast<std::size_t>(i)].joint;
    int q = model.position_offset(i);
    const int v = model.velocity_offset(i);
    const auto slide_one = [&](int at, int rate) {
      const auto p = static_cast<std::size_t>(at), d = static_cast<std::size_t>(rate);
      slide(c, from.q[p], from.qd[d], until.q[p], until.qd[d], to.q[p], to.qd[d]);
    };
    if (kind == JointKind::kHinge || kind == JointKind::kPrismatic) slide_one(q, v);
    const bool free = kind == JointKind::kFree;
    if (!free && kind != JointKind::kBall) continue;
    if (free) {
      for (int k = 0; k < 3; ++k) slide_one(q + k, v + 3 + k);
      q += 3;
    }
    const Quaterniond r0 = quaternion_at(from.q, q), r1 = quaternion_at(until.q, q);
    Vec3 s0 = three_at(from.qd, v), s1 = three_at(until.qd, v), s;
    if (free) {
      s0 = r0.conjugate() * s0;
      s1 = r1.conjugate() * s1;
    }
    Quaterniond r;
    turn(c, r0, s0, r1, s1, r, s);
    if (free) s = r * s;
    to.q[static_cast<std::size_t>(q)] = r.w();
    for (int k = 0; k < 3; ++k) to.q[static_cast<std::size_t>(q + 1 + k)] = r.vec()[k];
    for (int k = 0; k < 3; ++k) to.qd[static_cast<std::size_t>(v + k)] = s[k];
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

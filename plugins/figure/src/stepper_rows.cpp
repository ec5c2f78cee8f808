// Forces along rows, on top of what articulated bodies give: balls that lean on their ranges, pinned points.
// Equations (32) to (34) of doc/dynamics.md.
#include <algorithm>
#include <cmath>

#include "group_motion.h"
#include "stops_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

// Of the largest mobility: a row that the others keep already, or that nothing can move.
constexpr double kLeastPivot = 1e-10;
constexpr double kMostSettled = 0.05;  // rad, m of a joint at once: a chain that is taut has no way to go
constexpr int kMostSettling = 12;
constexpr double kSettled = 1e-15;  // m, rad, and of the fastest joint

double largest(const std::vector<double>& x) {
  double most = 0;
  for (const double v : x) most = std::max(most, std::abs(v));
  return most;
}

}  // namespace

void FigureStepper::Impl::make_room_for_rows() {
  const std::size_t n = state.qd.size();
  std::size_t most = 3 * pins.size();
  for (const Limited& joint : limited) most += joint.part != Limited::Part::kNumber;
  rows.reserve(most);
  columns.reserve(most * n);
  for (std::vector<double>* v : {&mobility, &factor}) v->reserve(most * most);
  for (std::vector<double>* v : {&right, &lambda, &row_wanted}) v->reserve(most);
  row_order.reserve(most);
  row_scratch.assign(n, 0.0);
  row_increment.assign(n, 0.0);
  row_kept.reserve(state.q.size());
  pinned_rates.reserve(n);
  pin_impulses.assign(pins.size(), Vec3::Zero());
  part_impulses = pin_impulses;
  pin_loads.clear();
  for (const Pin& pin : pins) pin_loads.push_back({pin.at.link, Vec3::Zero(), Vec3::Zero()});
}

bool FigureStepper::Impl::any_rows() const {
  if (!pins.empty()) return true;
  if (ball_ranges.empty() || limits == LimitMode::kNone) return false;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    if (limited[i].part != Limited::Part::kNumber && stops[i] != Stop::kFree) return true;
  }
  return false;
}

void FigureStepper::Impl::list_rows(const FigureState& at) {
  rows.clear();
  for (std::size_t i = 0; i < limited.size(); ++i) {
    if (limited[i].part == Limited::Part::kNumber || stops[i] == Stop::kFree) continue;
    const BallRange::Row row = row_of(limited[i], at);
    rows.push_back({static_cast<int>(i), -1, 0, row.gradient, row.bias});
  }
  for (std::size_t i = 0; i < pins.size(); ++i) {
    for (int k = 0; k < 3; ++k) rows.push_back({-1, static_cast<int>(i), k, Vec3::Zero(), 0});
  }
}

void FigureStepper::Impl::along_rows(const FigureState& at, const double* x, double* out) const {
  for (std::size_t r = 0; r < rows.size();) {
    if (rows[r].limited >= 0) {
      const int v = limited[static_cast<std::size_t>(rows[r].limited)].v;
      out[r] = rows[r].gradient.dot(Eigen::Map<const Vec3>(x + v));
      ++r;
      continue;
    }
    const Pin& pin = pins[static_cast<std::size_t>(rows[r].pin)];
    const Vec3 velocity = pin.chain.evaluate(pin.at.point, at.q.data(), x, nullptr).velocity;
    for (int k = 0; k < 3; ++k) out[r++] = velocity[k];
  }
}

// (32): H^-1 J^T, and J of it.
void FigureStepper::Impl::assemble_rows(const FigureState& at) {
  const std::size_t m = rows.size(), n = state.qd.size();
  columns.assign(m * n, 0.0);
  mobility.resize(m * m);
  for (std::size_t r = 0; r < m; ++r) {
    double* column = columns.data() + r * n;
    if (rows[r].limited >= 0) {
      const auto v = static_cast<std::size_t>(limited[static_cast<std::size_t>(rows[r].limited)].v);
      std::fill(row_scratch.begin(), row_scratch.end(), 0.0);
      for (std::size_t k = 0; k < 3; ++k) row_scratch[v + k] = rows[r].gradient[static_cast<int>(k)];
      dynamics.respond_to_torques(row_scratch.data(), column);
    } else {
      const Pin& pin = pins[static_cast<std::size_t>(rows[r].pin)];
      const Vec3 arm = pin.chain.evaluate(pin.at.point, at.q.data(), nullptr, nullptr).axes * pin.at.point;
      const Vec3 force = Vec3::Unit(rows[r].axis);
      const Wrench load{pin.at.link, arm.cross(force), force};
      dynamics.respond({&load, 1}, column);
    }
    along_rows(at, column, mobility.data() + r * m);
  }
}

// Cholesky's method with the largest pivot first; rows that depend on others get no force.
void FigureStepper::Impl::solve_rows() {
  const std::size_t m = rows.size();
  std::vector<double>& a = factor;
  a = mobility;
  const auto at = [&](std::size_t i, std::size_t k) -> double& {
    return a[static_cast<std::size_t>(row_order[i]) * m + static_cast<std::size_t>(row_order[k])];
  };
  row_order.resize(m);
  double most = 0;
  for (std::size_t i = 0; i < m; ++i) {
    row_order[i] = static_cast<int>(i);
    most = std::max(most, a[i * m + i]);
  }
  std::size_t rank = 0;
  for (; rank < m; ++rank) {
    std::size_t best = rank;
    for (std::size_t i = rank + 1; i < m; ++i) {
      if (at(i, i) > at(best, best)) best = i;
    }
    std::swap(row_order[rank], row_order[best]);
    if (!(at(rank, rank) > kLeastPivot * most)) break;
    const double root = std::sqrt(at(rank, rank));
    at(rank, rank) = root;
    for (std::size_t i = rank + 1; i < m; ++i) at(i, rank) /= root;
    for (std::size_t i = rank + 1; i < m; ++i) {  // all of it: either half may be looked at after a swap
      for (std::size_t k = rank + 1; k < m; ++k) at(i, k) -= at(i, rank) * at(k, rank);
    }
  }
  lambda.assign(m, 0.0);
  const auto x = [&](std::size_t i) -> double& { return lambda[static_cast<std::size_t>(row_order[i])]; };
  for (std::size_t i = 0; i < rank; ++i) {
    double sum = right[static_cast<std::size_t>(row_order[i])];
    for (std::size_t k = 0; k < i; ++k) sum -= at(i, k) * x(k);
    x(i) = sum / at(i, i);
  }
  for (std::size_t i = rank; i-- > 0;) {
    double sum = x(i);
    for (std::size_t k = i + 1; k < rank; ++k) sum -= at(k, i) * x(k);
    x(i) = sum / at(i, i);
  }
}

void FigureStepper::Impl::add_rows(double* to) const {
  const std::size_t n = state.qd.size();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double* column = columns.data() + r * n;
    for (std::size_t k = 0; k < n; ++k) to[k] += lambda[r] * column[k];
  }
}

// What the stops and pins give, for those who ask.
void FigureStepper::Impl::take_loads(const FigureState& at) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].limited >= 0) {
      ball_pulls[static_cast<std::size_t>(rows[r].limited)] = lambda[r];
      continue;
    }
    Wrench& load = pin_loads[static_cast<std::size_t>(rows[r].pin)];
    load.force[rows[r].axis] = lambda[r];
    if (rows[r].axis < 2) continue;
    const Pin& pin = pins[static_cast<std::size_t>(rows[r].pin)];
    const Vec3 arm = pin.chain.evaluate(pin.at.point, at.q.data(), nullptr, nullptr).axes * pin.at.point;
    load.moment = arm.cross(load.force);
  }
}

// (33).
void FigureStepper::Impl::keep_rows(const FigureState& at, double* qdd, Keep what) {
  if (!any_rows()) return;
  list_rows(at);
  row_wanted.assign(rows.size(), 0.0);
  if (what == Keep::kRates) {
    along_rows(at, at.qd.data(), row_wanted.data());
    for (double& w : row_wanted) w = -w;
  } else {
    for (std::size_t r = 0; r < rows.size(); ++r) row_wanted[r] = -rows[r].bias;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (rows[r].pin < 0 || rows[r].axis > 0) continue;
      const Pin& pin = pins[static_cast<std::size_t>(rows[r].pin)];
      const Vec3 bias = pin.chain.evaluate(pin.at.point, at.q.data(), at.qd.data(), nullptr).acceleration;
      for (std::size_t k = 0; k < 3; ++k) row_wanted[r + k] = -bias[static_cast<int>(k)];
    }
  }
  keep_rows_to(at, qdd, row_wanted);
}

void FigureStepper::Impl::keep_rows_to(const FigureState& at, double* qdd,
                                       const std::vector<double>& wanted) {
  assemble_rows(at);
  right.resize(rows.size());
  along_rows(at, qdd, right.data());
  for (std::size_t r = 0; r < rows.size(); ++r) right[r] = wanted[r] - right[r];
  solve_rows();
  add_rows(qdd);
  take_loads(at);
}

void FigureStepper::Impl::answer(const FigureState& at, const double* tau, double* qdd) {
  dynamics.forward(at.q.data(), at.qd.data(), tau, qdd);
  keep_rows(at, qdd, Keep::kAccelerations);
}

// (34).
void FigureStepper::Impl::settle_rows(FigureState& at) {
  if (!any_rows()) return;
  std::fill(row_increment.begin(), row_increment.end(), 0.0);
  dynamics.forward(at.q.data(), still.data(), nullptr, row_increment.data());
  list_rows(at);
  assemble_rows(at);
  right.resize(rows.size());
  double before = 1e300;
  for (int k = 0; k < kMostSettling; ++k) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (rows[r].limited >= 0) {
        const auto i = static_cast<std::size_t>(rows[r].limited);
        right[r] =
            (stops[i] == Stop::kLower ? limited[i].lower : limited[i].upper) - place_of(limited[i], at);
      } else if (rows[r].axis == 0) {
        const Pin& pin = pins[static_cast<std::size_t>(rows[r].pin)];
        const Vec3 off =
            pin.at.place - pin.chain.evaluate(pin.at.point, at.q.data(), nullptr, nullptr).position;
        for (std::size_t c = 0; c < 3; ++c) right[r + c] = off[static_cast<int>(c)];
      }
    }
    const double off = largest(right);
    if (off > before) at.q = row_kept;  // worse: what there was
    if (off <= kSettled || off > 0.9 * before) break;
    before = off;
    row_kept = at.q;
    solve_rows();
    std::fill(row_increment.begin(), row_increment.end(), 0.0);
    add_rows(row_increment.data());
    const double far = largest(row_increment);
    if (far > kMostSettled) {
      for (double& d : row_increment) d *= kMostSettled / far;
    }
    move_by(dynamics.model(), at.q.data(), row_increment.data(), at.q.data());
  }
  list_rows(at);
  before = 1e300;
  for (int k = 0; k < kMostSettling; ++k) {
    along_rows(at, at.qd.data(), right.data());
    const double off = largest(right);
    if (off > before) at.qd = row_kept;
    if (off <= kSettled * largest(at.qd) || off > 0.9 * before) break;
    before = off;
    row_kept = at.qd;
    for (double& r : right) r = -r;
    solve_rows();
    add_rows(at.qd.data());
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (rows[r].pin >= 0) part_impulses[static_cast<std::size_t>(rows[r].pin)][rows[r].axis] += lambda[r];
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

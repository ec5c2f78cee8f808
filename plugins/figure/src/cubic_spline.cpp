#include <algorithm>
#include <cmath>

#include "softpoint/core/error.h"
#include "softpoint/figure/spline.h"
#include "spline_pieces.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

void check_spline_times(const std::vector<double>& times, std::size_t values) {
  if (times.size() < 2) {
    throw Error("spline times: " + std::to_string(times.size()) + " of them; permitted are at least 2");
  }
  if (times.size() != values) {
    throw Error("spline values: " + std::to_string(values) + " of them; permitted are " +
                std::to_string(times.size()) + ", one a time");
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    check_range("spline time " + std::to_string(i), times[i], -1e9, 1e9);
    if (i > 0 && !(times[i] - times[i - 1] > 1e-9)) {
      throw Error("spline time " + std::to_string(i) + " = " + to_text(times[i]) + " after " +
                  to_text(times[i - 1]) + "; permitted are times that increase, by more than 1e-09 s");
    }
  }
}

std::size_t spline_piece(const std::vector<double>& times, double time) {
  const auto after = std::upper_bound(times.begin() + 1, times.end() - 1, time);
  return static_cast<std::size_t>(after - times.begin()) - 1;
}

namespace {

// A row of the tridiagonal system for the rates at the knots.
struct Row {
  double below, middle, above, right;
};

}  // namespace

CubicSpline::CubicSpline(std::vector<double> times, std::vector<double> values, const SplineEnd& first,
                         const SplineEnd& last)
    : times_(std::move(times)), values_(std::move(values)) {
  check_spline_times(times_, values_.size());
  for (std::size_t i = 0; i < values_.size(); ++i) {
    check_range("spline value " + std::to_string(i), values_[i], -1e12, 1e12);
  }
  for (const SplineEnd* end : {&first, &last}) {
    if (end->rate) check_range("spline end rate", *end->rate, -1e12, 1e12);
  }
  const std::size_t n = times_.size();
  const auto length = [&](std::size_t i) { return times_[i + 1] - times_[i]; };
  const auto slope = [&](std::size_t i) { return (values_[i + 1] - values_[i]) / length(i); };
  const auto open = [](const SplineEnd& end) { return !end.rate && !end.natural; };
  if (n == 2 && open(first) && open(last)) {
    rates_.assign(2, slope(0));
    return;
  }
  const bool parabola = n == 2 || (n == 3 && open(first) && open(last));
  // The row of an end whose nearest piece is `a`, the one beside it `b`.
  const auto end_row = [&](const SplineEnd& end, std::size_t a, std::size_t b) -> Row {
    if (end.rate) return {0, 1, 0, *end.rate};
    if (end.natural) return {1, 2, 1, 3 * slope(a)};
    if (parabola) return {1, 1, 1, 2 * slope(a)};
    const double both = length(a) + length(b);
    return {both, length(b), both,
            ((length(a) + 2 * both) * length(b) * slope(a) + length(a) * length(a) * slope(b)) / both};
  };
  std::vector<Row> rows(n);
  rows[0] = end_row(first, 0, n > 2 ? 1 : 0);
  rows[0].below = 0;
  rows[n - 1] = end_row(last, n - 2, n > 2 ? n - 3 : 0);
  rows[n - 1].above = 0;
  for (std::size_t i = 1; i + 1 < n; ++i) {  // equal accelerations from both sides
    const double a = 1 / length(i - 1), b = 1 / length(i);
    rows[i] = {a, 2 * (a + b), b, 3 * (a * slope(i - 1) + b * slope(i))};
  }
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = rows[i].below / rows[i - 1].middle;
    rows[i].middle -= factor * rows[i - 1].above;
    rows[i].right -= factor * rows[i - 1].right;
  }
  rates_.resize(n);
  for (std::size_t i = n; i-- > 0;) {
    rates_[i] = (rows[i].right - (i + 1 < n ? rows[i].above * rates_[i + 1] : 0)) / rows[i].middle;
  }
}

SplinePoint CubicSpline::at(double time) const {
  const std::size_t i = spline_piece(times_, time);
  const double h = times_[i + 1] - times_[i], u = (time - times_[i]) / h;
  const double rise = values_[i + 1] - values_[i], r0 = h * rates_[i], r1 = h * rates_[i + 1];
  const double c2 = 3 * rise - 2 * r0 - r1, c3 = r0 + r1 - 2 * rise;
  return {values_[i] + u * (r0 + u * (c2 + u * c3)), (r0 + u * (2 * c2 + 3 * u * c3)) / h,
          (2 * c2 + 6 * u * c3) / (h * h)};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

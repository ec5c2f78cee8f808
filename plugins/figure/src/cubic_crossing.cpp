#include "cubic_crossing.h"

#include <algorithm>
#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

// In u = t / length: c0 + c1 u + c2 u^2 + c3 u^3.
struct Cubic {
  double c0, c1, c2, c3;
  double operator()(double u) const { return c0 + u * (c1 + u * (c2 + u * c3)); }
};

}  // namespace

bool first_crossing(const CubicSpan& span, double& t, double& beyond) {
  const double rise = span.value1 - span.value0, r0 = span.rate0 * span.length, r1 = span.rate1 * span.length;
  const Cubic g{span.value0, r0, 3 * rise - 2 * r0 - r1, r0 + r1 - 2 * rise};
  // Ends of the pieces on which it is monotone.
  double ends[4] = {0, 1, 1, 1};
  int count = 1;
  const double disc = g.c2 * g.c2 - 3 * g.c3 * g.c1;
  if (disc > 0) {
    const double q = -(g.c2 + std::copysign(std::sqrt(disc), g.c2));
    double roots[2] = {g.c3 != 0 ? q / (3 * g.c3) : -1, q != 0 ? g.c1 / q : -1};
    if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
    for (const double u : roots) {
      if (u > 0 && u < 1) ends[count++] = u;
    }
  }
  ends[count++] = 1;
  for (int i = 0; i + 1 < count; ++i) {
    double low = ends[i], high = ends[i + 1];
    const double end = high == 1 ? span.value1 : g(high);
    if ((low == 0 ? span.value0 : g(low)) > 0 || !(end > 0)) continue;
    for (int k = 0; k < 60 && high - low > 1e-16; ++k) {
      const double middle = 0.5 * (low + high);
      (g(middle) > 0 ? high : low) = middle;
    }
    t = high * span.length;
    beyond = ends[i + 1] * span.length;
    return true;
  }
  return false;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

#include "anderson.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softpoint::inline SOFTPOINT_ABI::figure {

Anderson::Anderson(std::size_t size) : last_x_(size), last_g_(size) {
  for (int j = 0; j < kDepth; ++j) {
    dx_[j].resize(size);
    dg_[j].resize(size);
  }
}

void Anderson::move(std::vector<double>& x, const std::vector<double>& g) {
  const std::size_t n = x.size();
  if (taken_ > 0) {
    const int slot = (taken_ - 1) % kDepth;
    for (std::size_t k = 0; k < n; ++k) {
      dx_[slot][k] = x[k] - last_x_[k];
      dg_[slot][k] = g[k] - last_g_[k];
    }
    count_ = std::min(count_ + 1, kDepth);
  }
  ++taken_;
  std::copy(x.begin(), x.end(), last_x_.begin());
  std::copy(g.begin(), g.end(), last_g_.begin());
  // Normal equations, each difference scaled to length one.
  double a[kDepth][kDepth + 1], scale[kDepth];
  const auto dot_of = [n](const std::vector<double>& u, const std::vector<double>& v) {
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += u[k] * v[k];
    return sum;
  };
  for (int i = 0; i < count_; ++i) {
    const double length = std::sqrt(dot_of(dg_[i], dg_[i]));
    scale[i] = length > 0 ? 1 / length : 0;
  }
  for (int i = 0; i < count_; ++i) {
    for (int j = 0; j <= i; ++j) a[i][j] = a[j][i] = scale[i] * scale[j] * dot_of(dg_[i], dg_[j]);
    a[i][i] += 1e-13;
    a[i][count_] = scale[i] * dot_of(dg_[i], g);
  }
  for (int i = 0; i < count_; ++i) {  // positive definite: no pivots needed
    for (int r = i + 1; r < count_; ++r) {
      const double factor = a[r][i] / a[i][i];
      for (int c = i; c <= count_; ++c) a[r][c] -= factor * a[i][c];
    }
  }
  for (int i = count_; i-- > 0;) {
    for (int c = i + 1; c < count_; ++c) a[i][count_] -= a[i][c] * a[c][count_];
    a[i][count_] /= a[i][i];
  }
  for (std::size_t k = 0; k < n; ++k) {
    double sum = g[k];
    for (int i = 0; i < count_; ++i) sum -= scale[i] * a[i][count_] * (dx_[i][k] + dg_[i][k]);
    x[k] += sum;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

#pragma once

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Weights of the increments of a segment of `degree`, and their derivatives by u.
struct BernsteinWeights {
  double value[5], first[5], second[5];
};

inline double bernstein(int n, int i, double u) {
  constexpr double kChoose[6][6] = {{1},          {1, 1},          {1, 2, 1},
                                    {1, 3, 3, 1}, {1, 4, 6, 4, 1}, {1, 5, 10, 10, 5, 1}};
  if (i < 0 || i > n) return 0;
  double x = kChoose[n][i];
  for (int k = 0; k < i; ++k) x *= u;
  for (int k = i; k < n; ++k) x *= 1 - u;
  return x;
}

inline BernsteinWeights bernstein_weights(int degree, double u) {
  BernsteinWeights w{};
  double sum = 0;
  for (int i = degree; i >= 1; --i) {
    sum += bernstein(degree, i, u);
    w.value[i - 1] = sum;
    w.first[i - 1] = degree * bernstein(degree - 1, i - 1, u);
    w.second[i - 1] =
        degree * (degree - 1) * (bernstein(degree - 2, i - 2, u) - bernstein(degree - 2, i - 1, u));
  }
  return w;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

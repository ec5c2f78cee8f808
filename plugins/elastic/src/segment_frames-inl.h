// The small sums and turns of one segment's points: n of them, axis-major (all x, then all y, then all z).
// Matrices are column-major as Eigen's. Included by kernels-inl.h only.

// Halves onto each other: one lane after another would wait for the last.
SOFTPOINT_INLINE double sum_of_lanes(Pack v) {
#if SOFTPOINT_KERNEL_LANES == 8
  v = v + __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3);
  v = v + __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5);
#elif SOFTPOINT_KERNEL_LANES == 4
  v = v + __builtin_shufflevector(v, v, 2, 3, 0, 1);
#endif
  return v[0] + v[1];
}

// out[0..2] = sum of p, out[3 + 3 b + a] = sum of p_a arm_b.
void sum_moments(const double* p, const double* arms, Index n, double* out) {
  Pack sum[12] = {};
  double rest[12] = {};
  Index i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    const Pack x[3] = {load(p + i), load(p + n + i), load(p + 2 * n + i)};
    const Pack y[3] = {load(arms + i), load(arms + n + i), load(arms + 2 * n + i)};
#pragma GCC unroll 3
    for (int a = 0; a < 3; ++a) {
      sum[a] = sum[a] + x[a];
#pragma GCC unroll 3
      for (int b = 0; b < 3; ++b) sum[3 + 3 * b + a] = fma(x[a], y[b], sum[3 + 3 * b + a]);
    }
  }
  for (; i < n; ++i) {
    for (int a = 0; a < 3; ++a) {
      rest[a] += p[a * n + i];
      for (int b = 0; b < 3; ++b) rest[3 + 3 * b + a] += p[a * n + i] * arms[b * n + i];
    }
  }
  for (int k = 0; k < 12; ++k) out[k] = sum_of_lanes(sum[k]) + rest[k];
}

// d = R^T (p - mean) - arms.
void turn_back(const double* p, const double* mean, const double* r, const double* arms, Index n, double* d) {
  for (int a = 0; a < 3; ++a) {
    const double r0 = r[3 * a], r1 = r[3 * a + 1], r2 = r[3 * a + 2];
    const double* const arm = arms + a * n;
    double* const out = d + a * n;
    for (Index i = 0; i < n; ++i) {
      out[i] = r0 * (p[i] - mean[0]) + r1 * (p[n + i] - mean[1]) + r2 * (p[2 * n + i] - mean[2]) - arm[i];
    }
  }
}

// out[0] = d . f, out[1] = f . f, out[2..4] = sum of (arms + d) x f.
void sum_forces(const double* d, const double* f, const double* arms, Index n, double* out) {
  Pack sum[5] = {};
  double rest[5] = {};
  Index i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    const Pack u[3] = {load(d + i), load(d + n + i), load(d + 2 * n + i)};
    const Pack g[3] = {load(f + i), load(f + n + i), load(f + 2 * n + i)};
    const Pack x[3] = {load(arms + i) + u[0], load(arms + n + i) + u[1], load(arms + 2 * n + i) + u[2]};
#pragma GCC unroll 3
    for (int a = 0; a < 3; ++a) {
      sum[0] = fma(u[a], g[a], sum[0]);
      sum[1] = fma(g[a], g[a], sum[1]);
    }
    sum[2] = sum[2] + (x[1] * g[2] - x[2] * g[1]);
    sum[3] = sum[3] + (x[2] * g[0] - x[0] * g[2]);
    sum[4] = sum[4] + (x[0] * g[1] - x[1] * g[0]);
  }
  for (; i < n; ++i) {
    double x[3], g[3];
    for (int a = 0; a < 3; ++a) {
      x[a] = arms[a * n + i] + d[a * n + i];
      g[a] = f[a * n + i];
      rest[0] += d[a * n + i] * g[a];
      rest[1] += g[a] * g[a];
    }
    rest[2] += x[1] * g[2] - x[2] * g[1];
    rest[3] += x[2] * g[0] - x[0] * g[2];
    rest[4] += x[0] * g[1] - x[1] * g[0];
  }
  for (int k = 0; k < 5; ++k) out[k] = sum_of_lanes(sum[k]) + rest[k];
}

// f <- R (f - a x arms).
void turn_forces(double* f, const double* a, const double* r, const double* arms, Index n) {
  for (Index i = 0; i < n; ++i) {
    const double x = arms[i], y = arms[n + i], z = arms[2 * n + i];
    const double fx = f[i] - (a[1] * z - a[2] * y);
    const double fy = f[n + i] - (a[2] * x - a[0] * z);
    const double fz = f[2 * n + i] - (a[0] * y - a[1] * x);
    f[i] = r[0] * fx + r[3] * fy + r[6] * fz;
    f[n + i] = r[1] * fx + r[4] * fy + r[7] * fz;
    f[2 * n + i] = r[2] * fx + r[5] * fy + r[8] * fz;
  }
}

// Points one after another, x y z: out_i = at + R (rest_i + u_i).
template <class Real>
void place_points(const double* rest, const Real* u, const double* r, const double* at, Index n,
                  double* out) {
  for (Index i = 0; i < n; ++i) {
    const double x = rest[i] + u[i], y = rest[n + i] + u[n + i], z = rest[2 * n + i] + u[2 * n + i];
    out[3 * i] = at[0] + r[0] * x + r[3] * y + r[6] * z;
    out[3 * i + 1] = at[1] + r[1] * x + r[4] * y + r[7] * z;
    out[3 * i + 2] = at[2] + r[2] * x + r[5] * y + r[8] * z;
  }
}

void to_single(const double* from, Index n, float* to) {
  for (Index i = 0; i < n; ++i) to[i] = static_cast<float>(from[i]);
}

void to_double(const float* from, Index n, double* to) {
  for (Index i = 0; i < n; ++i) to[i] = from[i];
}

// Tridiagonal solves along the rows and columns of a grid. Included by march_kernels-inl.h only.

// to[j][i] = from[i][j], for i < rows and j < columns, rows rounded up to the lanes of a vector and columns
// to four: blocks of four numbers from each of `lanes` rows are turned within the 16 bytes they share.
#if SOFTPOINT_KERNEL_BYTES == 64
#define SOFTPOINT_LOW(a, b) \
  __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29)
#define SOFTPOINT_HIGH(a, b) \
  __builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31)
#define SOFTPOINT_FIRST(a, b) \
  __builtin_shufflevector(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29)
#define SOFTPOINT_SECOND(a, b) \
  __builtin_shufflevector(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31)
SOFTPOINT_INLINE Pack<float> each_fourth(const float* p, long stride) {
  const __m512 a = _mm512_zextps128_ps512(_mm_loadu_ps(p));
  const __m512 b = _mm512_maskz_insertf32x4(0xffff, a, _mm_loadu_ps(p + 4 * stride), 1);
  const __m512 c = _mm512_maskz_insertf32x4(0xffff, b, _mm_loadu_ps(p + 8 * stride), 2);
  return _mm512_maskz_insertf32x4(0xffff, c, _mm_loadu_ps(p + 12 * stride), 3);
}
#elif SOFTPOINT_KERNEL_BYTES == 32
#define SOFTPOINT_LOW(a, b) __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13)
#define SOFTPOINT_HIGH(a, b) __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15)
#define SOFTPOINT_FIRST(a, b) __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13)
#define SOFTPOINT_SECOND(a, b) __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15)
SOFTPOINT_INLINE Pack<float> each_fourth(const float* p, long stride) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p)), _mm_loadu_ps(p + 4 * stride), 1);
}
#else
#define SOFTPOINT_LOW(a, b) __builtin_shufflevector(a, b, 0, 4, 1, 5)
#define SOFTPOINT_HIGH(a, b) __builtin_shufflevector(a, b, 2, 6, 3, 7)
#define SOFTPOINT_FIRST(a, b) __builtin_shufflevector(a, b, 0, 1, 4, 5)
#define SOFTPOINT_SECOND(a, b) __builtin_shufflevector(a, b, 2, 3, 6, 7)
SOFTPOINT_INLINE Pack<float> each_fourth(const float* p, long) { return load(p); }
#endif

SOFTPOINT_INLINE void turn(const float* from, long from_stride, long rows, long columns, float* to,
                           long to_stride) {
  for (long i = 0; i < rows; i += Of<float>::lanes) {
    for (long j = 0; j < columns; j += 4) {
      const float* p = from + i * from_stride + j;
      float* q = to + j * to_stride + i;
      const Pack<float> a = each_fourth(p, from_stride), b = each_fourth(p + from_stride, from_stride),
                        c = each_fourth(p + 2 * from_stride, from_stride),
                        e = each_fourth(p + 3 * from_stride, from_stride);
      const Pack<float> ab = SOFTPOINT_LOW(a, b), ba = SOFTPOINT_HIGH(a, b), ce = SOFTPOINT_LOW(c, e),
                        ec = SOFTPOINT_HIGH(c, e);
      store(q, SOFTPOINT_FIRST(ab, ce));
      store(q + to_stride, SOFTPOINT_SECOND(ab, ce));
      store(q + 2 * to_stride, SOFTPOINT_FIRST(ba, ec));
      store(q + 3 * to_stride, SOFTPOINT_SECOND(ba, ec));
    }
  }
}
SOFTPOINT_INLINE void turn(const double* from, long from_stride, long rows, long columns, double* to,
                           long to_stride) {
  typedef double Two __attribute__((vector_size(16), aligned(8), may_alias));
  for (long i = 0; i < rows; i += 2) {
    for (long j = 0; j < columns; j += 2) {
      const double* p = from + i * from_stride + j;
      double* q = to + j * to_stride + i;
      const Two a = *reinterpret_cast<const Two*>(p), b = *reinterpret_cast<const Two*>(p + from_stride);
      *reinterpret_cast<Two*>(q) = __builtin_shufflevector(a, b, 0, 2);
      *reinterpret_cast<Two*>(q + to_stride) = __builtin_shufflevector(a, b, 1, 3);
    }
  }
}

// `lower` holds what couples each line with the next one; with `pivot` it becomes the factor of
// (1 + D) = C E C^T: pivots are the inverse of E, `lower` what is beside the ones of C less its signs.
template <class T>
SOFTPOINT_INLINE void factor_lines(T* lower, T* pivot, long lines, long stride) {
  for (long i = 0; i < stride; i += Of<T>::lanes) {
    Pack<T> before{}, inverse{};
    for (long line = 0; line < lines; ++line) {
      const Pack<T> after = load(lower + line * stride + i), left = before * inverse;
      inverse = T(1) / (T(1) + after + before - left * before);
      store(lower + line * stride + i, left);
      store(pivot + line * stride + i, inverse);
      before = after;
    }
  }
}

// a <- C^-1 a and a <- C^-T E^-1 a; line after line, so that many right sides go along at once.
template <class T>
SOFTPOINT_INLINE void solve_down(T* const* a, T* const* lower, long lines, long stride) {
  for (long i = stride; i < lines * stride; i += Of<T>::lanes) {
    for (int k = 0; k < 3; ++k) {
      store(a[k] + i, fma(load(lower[k] + i), load(a[k] + i - stride), load(a[k] + i)));
    }
  }
}
template <class T>
SOFTPOINT_INLINE void solve_up(T* const* a, T* const* lower, T* const* pivot, long lines, long stride) {
  for (long i = (lines - 1) * stride; i < lines * stride; i += Of<T>::lanes) {
    for (int k = 0; k < 3; ++k) store(a[k] + i, load(pivot[k] + i) * load(a[k] + i));
  }
  for (long i = (lines - 1) * stride - Of<T>::lanes; i >= 0; i -= Of<T>::lanes) {
    for (int k = 0; k < 3; ++k) {
      const Pack<T> far = load(lower[k] + i + stride) * load(a[k] + i + stride);
      store(a[k] + i, fma(load(pivot[k] + i), load(a[k] + i), far));
    }
  }
}

// How stiff a spring along r is in each direction, with what it couples between directions added: such
// diagonal matrices together are no less stiff than the springs.
template <class T>
SOFTPOINT_INLINE Pack3<T> stiff_along(Pack<T> k, const Pack3<T>& r) {
  const Pack<T> zero{};
  const Pack3<T> a = {r.x < zero ? -r.x : r.x, r.y < zero ? -r.y : r.y, r.z < zero ? -r.z : r.z};
  const Pack<T> scale = (a.x + a.y + a.z) / (dot<T>(r, r) + T(1e-30)), least = splat(T(0.024));
  const Pack3<T> s = {scale * a.x, scale * a.y, scale * a.z};
  return {k * (s.x > least ? s.x : least), k * (s.y > least ? s.y : least), k * (s.z > least ? s.z : least)};
}

// Of a spring across a cell, for each of the four sides it goes along: one would do for certain.
constexpr double kDiagonal = 0.35;
template <class T>
void factor(const MarchData<T>& given, T share) {
  const MarchData<T> d = given;
  const long s = d.stride, count = d.rows * s;
  for (long i = 0; i < count; i += Of<T>::lanes) {
    const Pack<T> per_mass = T(kDiagonal) * share * load(d.inverse_mass + i);
    store3(d.cells[0], d.cells[1], d.cells[2], i,
           stiff_along<T>(per_mass * load(d.stiffness[2] + i), arm<T>(d, i, s + 1)) +
               stiff_along<T>(per_mass * load(d.stiffness[3] + i + 1), arm<T>(d, i + 1, s - 1)));
  }
  for (long i = 0; i < count; i += Of<T>::lanes) {
    const Pack<T> per_mass = share * load(d.inverse_mass + i);
    const Pack3<T> diagonal = load3(d.cells[0], d.cells[1], d.cells[2], i);
    store3(d.f[0], d.f[1], d.f[2], i,
           stiff_along<T>(per_mass * load(d.stiffness[0] + i), arm<T>(d, i, 1)) + diagonal +
               load3(d.cells[0], d.cells[1], d.cells[2], i - s));
    store3(d.lower[0], d.lower[1], d.lower[2], i,
           scaled<T>(splat(T(0.25)), stiff_along<T>(per_mass * load(d.stiffness[1] + i), arm<T>(d, i, s)) +
                                         diagonal + load3(d.cells[0], d.cells[1], d.cells[2], i - 1)));
  }
  for (int k = 0; k < 3; ++k) {
    turn(d.f[k], s, d.rows, d.columns, d.turned_lower[k], d.turned_stride);
    factor_lines(d.lower[k], d.pivot[k], d.rows, s);
    factor_lines(d.turned_lower[k], d.turned_pivot[k], d.columns, d.turned_stride);
  }
}

// As solve_up, of the changes of v, which then move the points.
template <class T>
SOFTPOINT_INLINE double solve_up_and_go(const MarchData<T>& d, T h) {
  const Pack<T> far = splat(h * d.per_unit);
  Pack<T> swept[3] = {};
  const auto go = [&](int k, long i, Pack<T> change) {
    store(d.f[k] + i, change);
    const Pack<T> v = load(d.v[k] + i) + change;
    store(d.v[k] + i, v);
    shift(d.x[k] + i, far * v);
    swept[k] = fma(v, load(d.g[k] + i), swept[k]);
  };
  const long s = d.stride;
  for (long i = (d.rows - 1) * s; i < d.rows * s; i += Of<T>::lanes) {
    for (int k = 0; k < 3; ++k) go(k, i, load(d.pivot[k] + i) * load(d.f[k] + i));
  }
  for (long line = d.rows - 2; line >= 0; --line) {
    for (long i = line * s; i < (line + 1) * s; i += Of<T>::lanes) {
      for (int k = 0; k < 3; ++k) {
        const Pack<T> next = load(d.lower[k] + i + s) * load(d.f[k] + i + s);
        go(k, i, fma(load(d.pivot[k] + i), load(d.f[k] + i), next));
      }
    }
  }
  return sum<T>(swept[0]) + sum<T>(swept[1]) + sum<T>(swept[2]);
}

// Symmetric, so that the smoothed motion has an energy to keep: columns, rows, columns. As (1 + D/4)^2 is no
// less than D a quarter of the columns' stiffness does on either side; whole solves on both sides, not the
// two halves of one, because the halves do not leave what is even along a column as it is.
template <class T>
double move(const MarchData<T>& given, T h) {
  const MarchData<T> d = given;
  solve_down<T>(d.f, d.lower, d.rows, d.stride);
  solve_up<T>(d.f, d.lower, d.pivot, d.rows, d.stride);
  for (int k = 0; k < 3; ++k) turn(d.f[k], d.stride, d.rows, d.columns, d.turned[k], d.turned_stride);
  solve_down<T>(d.turned, d.turned_lower, d.columns, d.turned_stride);
  solve_up<T>(d.turned, d.turned_lower, d.turned_pivot, d.columns, d.turned_stride);
  for (int k = 0; k < 3; ++k) turn(d.turned[k], d.turned_stride, d.columns, d.rows, d.f[k], d.stride);
  solve_down<T>(d.f, d.lower, d.rows, d.stride);
  return solve_up_and_go<T>(d, h);
}

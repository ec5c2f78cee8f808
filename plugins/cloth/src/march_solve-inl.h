// Tridiagonal solves along the rows and columns of a grid. Included by march_kernels-inl.h only.

// to[j][i] = from[i][j], for i < rows and j < columns, both rounded up to four.
template <class T>
SOFTPOINT_INLINE void turn(const T* from, long from_stride, long rows, long columns, T* to, long to_stride) {
  typedef T Four __attribute__((vector_size(4 * sizeof(T)), aligned(sizeof(T)), may_alias));
  for (long i = 0; i < rows; i += 4) {
    for (long j = 0; j < columns; j += 4) {
      const T* p = from + i * from_stride + j;
      T* q = to + j * to_stride + i;
      const Four a = *reinterpret_cast<const Four*>(p);
      const Four b = *reinterpret_cast<const Four*>(p + from_stride);
      const Four c = *reinterpret_cast<const Four*>(p + 2 * from_stride);
      const Four e = *reinterpret_cast<const Four*>(p + 3 * from_stride);
      const Four ab = __builtin_shufflevector(a, b, 0, 4, 1, 5),
                 ba = __builtin_shufflevector(a, b, 2, 6, 3, 7);
      const Four ce = __builtin_shufflevector(c, e, 0, 4, 1, 5),
                 ec = __builtin_shufflevector(c, e, 2, 6, 3, 7);
      *reinterpret_cast<Four*>(q) = __builtin_shufflevector(ab, ce, 0, 1, 4, 5);
      *reinterpret_cast<Four*>(q + to_stride) = __builtin_shufflevector(ab, ce, 2, 3, 6, 7);
      *reinterpret_cast<Four*>(q + 2 * to_stride) = __builtin_shufflevector(ba, ec, 0, 1, 4, 5);
      *reinterpret_cast<Four*>(q + 3 * to_stride) = __builtin_shufflevector(ba, ec, 2, 3, 6, 7);
    }
  }
}

// `lower` holds what couples each line with the next one; with `pivot` it becomes the factor of
// (1 + D) = C C^T: pivots are the inverse of C's diagonal, `lower` the rest of it less its signs.
template <class T>
SOFTPOINT_INLINE void factor_lines(T* lower, T* pivot, long lines, long stride) {
  for (long i = 0; i < stride; i += Of<T>::lanes) {
    Pack<T> before{}, inverse{};
    for (long line = 0; line < lines; ++line) {
      const Pack<T> after = load(lower + line * stride + i), left = before * inverse;
      inverse = T(1) / sqrt(T(1) + after + before - left * left);
      store(lower + line * stride + i, left);
      store(pivot + line * stride + i, inverse);
      before = after;
    }
  }
}

// a <- C^-1 a and a <- C^-T a; line after line, so that many right sides go along at once.
template <class T>
SOFTPOINT_INLINE void solve_down(T* const* a, T* const* lower, T* const* pivot, long lines, long stride) {
  for (long i = 0; i < stride; i += Of<T>::lanes) {
    for (int k = 0; k < 3; ++k) store(a[k] + i, load(pivot[k] + i) * load(a[k] + i));
  }
  for (long i = stride; i < lines * stride; i += Of<T>::lanes) {
    for (int k = 0; k < 3; ++k) {
      const Pack<T> sum = fma(load(lower[k] + i), load(a[k] + i - stride), load(a[k] + i));
      store(a[k] + i, load(pivot[k] + i) * sum);
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
      const Pack<T> sum = fma(load(lower[k] + i + stride), load(a[k] + i + stride), load(a[k] + i));
      store(a[k] + i, load(pivot[k] + i) * sum);
    }
  }
}

// How stiff a spring along r is in each direction, with what it couples between directions added: the sum
// of such diagonal matrices bounds the stiffness. 0.7 of that has proved enough.
template <class T>
SOFTPOINT_INLINE Pack3<T> stiff_along(Pack<T> k, const Pack3<T>& r) {
  const Pack<T> zero{};
  const Pack3<T> a = {r.x < zero ? -r.x : r.x, r.y < zero ? -r.y : r.y, r.z < zero ? -r.z : r.z};
  const Pack<T> scale = T(0.7) * (a.x + a.y + a.z) / (dot<T>(r, r) + T(1e-30)), least = splat(T(0.02));
  const Pack3<T> s = {scale * a.x, scale * a.y, scale * a.z};
  return {k * (s.x > least ? s.x : least), k * (s.y > least ? s.y : least), k * (s.z > least ? s.z : least)};
}

template <class T>
void factor(const MarchData<T>& given, T share) {
  const MarchData<T> d = given;
  const long s = d.stride, count = d.rows * s;
  for (long i = 0; i < count; i += Of<T>::lanes) {
    const Pack<T> per_mass = T(0.5) * share * load(d.inverse_mass + i);
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
           stiff_along<T>(per_mass * load(d.stiffness[1] + i), arm<T>(d, i, s)) + diagonal +
               load3(d.cells[0], d.cells[1], d.cells[2], i - 1));
  }
  for (int k = 0; k < 3; ++k) {
    turn(d.f[k], s, d.rows, d.columns, d.turned_lower[k], d.turned_stride);
    factor_lines(d.lower[k], d.pivot[k], d.rows, s);
    factor_lines(d.turned_lower[k], d.turned_pivot[k], d.columns, d.turned_stride);
  }
}

// Symmetric, so that the smoothed motion has an energy to keep: half of the columns, the rows, the other
// half.
template <class T>
void smooth(const MarchData<T>& given) {
  const MarchData<T> d = given;
  solve_down<T>(d.f, d.lower, d.pivot, d.rows, d.stride);
  for (int k = 0; k < 3; ++k) turn(d.f[k], d.stride, d.rows, d.columns, d.turned[k], d.turned_stride);
  solve_down<T>(d.turned, d.turned_lower, d.turned_pivot, d.columns, d.turned_stride);
  solve_up<T>(d.turned, d.turned_lower, d.turned_pivot, d.columns, d.turned_stride);
  for (int k = 0; k < 3; ++k) turn(d.turned[k], d.turned_stride, d.columns, d.rows, d.f[k], d.stride);
  solve_up<T>(d.f, d.lower, d.pivot, d.rows, d.stride);
}

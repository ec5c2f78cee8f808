// The body of every march_kernels_*.cpp: SOFTPOINT_KERNEL_NAME and SOFTPOINT_KERNEL_BYTES are set before.
#include "march_kernels.h"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace softpoint::inline SOFTPOINT_ABI::cloth {
// Nameless, and the code calls nothing outside: no symbol but the table leaves this file.
namespace {

#include "pack-inl.h"

typedef int Whole __attribute__((vector_size(SOFTPOINT_KERNEL_BYTES)));
typedef int LooseWhole __attribute__((vector_size(SOFTPOINT_KERNEL_BYTES), aligned(4), may_alias));

// From `to` less from `from`, m.
SOFTPOINT_INLINE Pack<float> way(const int* to, const int* from, float unit) {
  const Whole d = *reinterpret_cast<const LooseWhole*>(to) - *reinterpret_cast<const LooseWhole*>(from);
  return unit * __builtin_convertvector(d, Pack<float>);
}
SOFTPOINT_INLINE Pack<double> way(const double* to, const double* from, double) {
  return load(to) - load(from);
}
SOFTPOINT_INLINE void shift(int* x, Pack<float> by, float per_unit) {
  by *= per_unit;
  by += by < 0.0f ? splat(-0.5f) : splat(0.5f);  // to the nearest: the conversion cuts off
  LooseWhole& out = *reinterpret_cast<LooseWhole*>(x);
  out = out + __builtin_convertvector(by, Whole);
}
SOFTPOINT_INLINE void shift(double* x, Pack<double> by, double) { store(x, load(x) + by); }

template <class T>
SOFTPOINT_INLINE Pack3<T> arm(const MarchData<T>& d, long at, long offset) {
  return {way(d.x[0] + at + offset, d.x[0] + at, d.unit), way(d.x[1] + at + offset, d.x[1] + at, d.unit),
          way(d.x[2] + at + offset, d.x[2] + at, d.unit)};
}
template <class T>
SOFTPOINT_INLINE Pack3<T> cross(const Pack3<T>& a, const Pack3<T>& b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}
template <class T>
SOFTPOINT_INLINE Pack3<T> scaled(Pack<T> s, const Pack3<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}

// 1/sqrt(v) to 2 ulp. With AVX-512 from its 14 bits, which are the same on every processor.
SOFTPOINT_INLINE Pack<float> inverse_length(Pack<float> v) {
#if SOFTPOINT_KERNEL_BYTES == 64
  const Pack<float> y = _mm512_maskz_rsqrt14_ps(0xffff, v);
  return y * fma(v * -0.5f * y, y, splat(1.5f));
#else
  return inverse_root(v);
#endif
}
SOFTPOINT_INLINE Pack<double> inverse_length(Pack<double> v) { return inverse_root(v); }

// Pulls of the springs from the points of the row that begins at `begin`, dampers included.
template <class T>
SOFTPOINT_INLINE void row_springs(const MarchData<T>& d, long begin, T* out, long width) {
  const long offset[] = {1, d.stride, d.stride + 1, d.stride - 1};
  for (long i = 0; i < d.stride; i += Of<T>::lanes) {
    const long at = begin + i;
    const Pack3<T> v = load3(d.v[0], d.v[1], d.v[2], at);
    for (int family = 0; family < MarchData<T>::kFamilies; ++family) {
      const Pack3<T> r = arm<T>(d, at, offset[family]);
      const Pack<T> square = dot<T>(r, r) + T(1e-30);
      const Pack<T> inverse = inverse_length(square);
      const Pack<T> stretch = square * inverse - d.rest[family];
      const Pack<T> k = load(d.stiffness[family] + at);
      const Pack<T> elastic = (stretch < T(0) ? k * d.compression : k) * stretch;
      const Pack3<T> u = load3(d.v[0], d.v[1], d.v[2], at + offset[family]) - v;
      const Pack<T> pull = fma(k * d.damping_time, dot<T>(u, r) * inverse, elastic) * inverse;
      T* to = out + 3 * family * width;
      store3(to, to + width, to + 2 * width, i, scaled<T>(pull, r));
    }
  }
}

// What the faces of the cells of a row give to their corners a, b, c, d.
template <class T>
SOFTPOINT_INLINE void row_cells(const MarchData<T>& d, long begin, T* out, long width) {
  for (long i = 0; i < d.stride; i += Of<T>::lanes) {
    const long at = begin + i;
    const Pack3<T> b = arm<T>(d, at, 1), c = arm<T>(d, at, d.stride + 1), e = arm<T>(d, at, d.stride);
    const Pack3<T> abc = scaled<T>(load(d.faces[0] + at), cross<T>(b, c));
    const Pack3<T> acd = scaled<T>(load(d.faces[1] + at), cross<T>(c, e));
    const Pack3<T> abd = scaled<T>(load(d.faces[2] + at), cross<T>(b, e));
    const Pack3<T> bcd = scaled<T>(load(d.faces[3] + at), cross<T>(c - b, e - b));
    store3(out, out + width, out + 2 * width, i, abc + acd + abd);
    store3(out + 3 * width, out + 4 * width, out + 5 * width, i, abc + abd + bcd);
    store3(out + 6 * width, out + 7 * width, out + 8 * width, i, abc + acd + bcd);
    store3(out + 9 * width, out + 10 * width, out + 11 * width, i, acd + abd + bcd);
  }
}

// Coulomb's friction and the push of the plane as forces, before anything is smoothed: what rests is in
// balance by the forces alone. Of a point that has come through its plane, a fifth of the way is taken back.
// `f` without contact becomes the change of v.
template <class T>
SOFTPOINT_INLINE void meet(const MarchData<T>& d, long i, Pack3<T> f, T h) {
  const Pack<T> rate = splat(T(1) / h), none = splat(T(0));
  const Pack<T> mass = load(d.mass + i), per_step = mass * rate;
  const Pack3<T> v = load3(d.v[0], d.v[1], d.v[2], i), n = load3(d.normal[0], d.normal[1], d.normal[2], i);
  const Pack3<T> a = load3(d.acceleration[0], d.acceleration[1], d.acceleration[2], i);
  f = madd<T>(mass, a - scaled<T>(splat(d.drag_rate), v), f);
  const Pack3<T> over = {way(d.x[0] + i, d.foot[0] + i, d.unit), way(d.x[1] + i, d.foot[1] + i, d.unit),
                         way(d.x[2] + i, d.foot[2] + i, d.unit)};
  const Pack<T> gap = dot<T>(over, n);
  const Pack<T> wanted = -rate * (gap < none ? T(0.2) * gap : gap);
  const Pack<T> push =
      max0<T>(per_step * (wanted - dot<T>(v, n)) - dot<T>(f, n)) * dot<T>(n, n);  // 0 where there is no plane
  const Mask<T> touches = push > none;
  Pack<T> touch = none;
  if (any<T>(touches)) {
    f = madd<T>(push, n, f);
    const Pack3<T> whole = madd<T>(per_step, v, f);
    const Pack3<T> slip = madd<T>(-dot<T>(whole, n), n, whole);
    const Pack<T> limit = load(d.friction + i) * (push + load(d.adhesion + i));
    const Pack<T> square = dot<T>(slip, slip) + T(1e-30);
    const Mask<T> slides = square > limit * limit;
    const Pack<T> part = touches ? (slides ? -limit * inverse_length(square) : splat(T(-1))) : none;
    f = madd<T>(part, slip, f);
    const Pack3<T> contact = madd<T>(push, n, scaled<T>(part, slip));
    store3(d.c[0], d.c[1], d.c[2], i, contact + load3(d.c[0], d.c[1], d.c[2], i));
    touch = touches ? (slides ? splat(T(2)) : splat(T(1))) : none;
  }
  store(d.touch + i, touch);
  store3(d.f[0], d.f[1], d.f[2], i, scaled<T>(h * load(d.inverse_mass + i), f));
}

template <class T>
void push(const MarchData<T>& given, MarchAir air, T gauge, T h) {
  const MarchData<T> d = given;  // of which no store can be suspected to change the pointers
  constexpr int kArrays = MarchData<T>::kRowArrays, kSprings = 3 * MarchData<T>::kFamilies;
  const long s = d.stride, width = s + MarchData<T>::kPadding;
  T* here = d.scratch + kMarchLanes;
  T* below = here + kArrays * width;
  for (long i = -kMarchLanes; i < kArrays * width - kMarchLanes; ++i) below[i] = T(0);
  for (long row = 0; row < d.rows; ++row) {
    const long begin = row * s;
    row_springs<T>(d, begin, here, width);
    T* const cells = here + kSprings * width;
    const T* const cells_below = below + kSprings * width;
    if (air == MarchAir::kMeasured) row_cells<T>(d, begin, cells, width);
    for (long i = 0; i < s; i += Of<T>::lanes) {
      Pack<T> force[3];
      for (int k = 0; k < 3; ++k) {
        const T *h0 = here + k * width + i, *b = below + k * width + i;
        force[k] = load(h0) - load(h0 - 1) + (load(h0 + 3 * width) - load(b + 3 * width)) +
                   (load(h0 + 6 * width) - load(b + 6 * width - 1)) +
                   (load(h0 + 9 * width) - load(b + 9 * width + 1));
        if (air == MarchAir::kNone) continue;
        if (air == MarchAir::kKept) {
          force[k] = fma(splat(gauge), load(d.g[k] + begin + i), force[k]);
          continue;
        }
        const T *p = cells + k * width + i, *q = cells_below + k * width + i;
        const Pack<T> g = load(p) + load(p + 3 * width - 1) +
                          (load(q + 6 * width - 1) + load(q + 9 * width)) + load(d.rim[k] + begin + i);
        store(d.g[k] + begin + i, g);
        force[k] = fma(splat(gauge), g, force[k]);
      }
      meet<T>(d, begin + i, {force[0], force[1], force[2]}, h);
    }
    T* const other = here;
    here = below;
    below = other;
  }
}

template <class T>
double advance(const MarchData<T>& given, T h) {
  const MarchData<T> d = given;
  double total = 0;
  for (int k = 0; k < 3; ++k) {
    Pack<T> swept{};
    for (long i = 0; i < d.rows * d.stride; i += Of<T>::lanes) {
      const Pack<T> v = load(d.v[k] + i) + load(d.f[k] + i);
      store(d.v[k] + i, v);
      shift(d.x[k] + i, h * v, d.per_unit);
      swept = fma(v, load(d.g[k] + i), swept);
    }
    total += sum<T>(swept);
  }
  return total;
}

// after all that it uses
#include "march_solve-inl.h"

constexpr MarchKernelTable kMarchKernels = {{push<float>, factor<float>, smooth<float>, advance<float>},
                                            {push<double>, factor<double>, smooth<double>, advance<double>}};

}  // namespace

const MarchKernelTable* SOFTPOINT_KERNEL_NAME() { return &kMarchKernels; }

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

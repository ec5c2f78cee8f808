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

// Places of neighbours in memory, and how far one lies from another, in units.
template <class T>
struct Places;
template <>
struct Places<float> {
  Whole x;
};
template <>
struct Places<double> {
  Pack<double> x;
};
SOFTPOINT_INLINE Places<float> places(const int* p) { return {*reinterpret_cast<const LooseWhole*>(p)}; }
SOFTPOINT_INLINE Places<double> places(const double* p) { return {load(p)}; }
SOFTPOINT_INLINE Pack<float> way(Places<float> to, Places<float> from) {
  return __builtin_convertvector(to.x - from.x, Pack<float>);
}
SOFTPOINT_INLINE Pack<double> way(Places<double> to, Places<double> from) { return to.x - from.x; }
SOFTPOINT_INLINE void shift(int* x, Pack<float> by) {
  by += by < 0.0f ? splat(-0.5f) : splat(0.5f);  // to the nearest: the conversion cuts off
  LooseWhole& out = *reinterpret_cast<LooseWhole*>(x);
  out = out + __builtin_convertvector(by, Whole);
}
SOFTPOINT_INLINE void shift(double* x, Pack<double> by) { store(x, load(x) + by); }

template <class T>
struct Places3 {
  Places<T> x, y, z;
};
template <class T>
SOFTPOINT_INLINE Places3<T> places3(const typename MarchPlace<T>::Type* const* x, long at) {
  return {places(x[0] + at), places(x[1] + at), places(x[2] + at)};
}
template <class T>
SOFTPOINT_INLINE Pack3<T> way3(const Places3<T>& to, const Places3<T>& from) {
  return {way(to.x, from.x), way(to.y, from.y), way(to.z, from.z)};
}
template <class T>
SOFTPOINT_INLINE Pack3<T> arm(const MarchData<T>& d, long at, long offset) {
  return way3<T>(places3<T>(d.x, at + offset), places3<T>(d.x, at));
}
template <class T>
SOFTPOINT_INLINE Pack3<T> cross(const Pack3<T>& a, const Pack3<T>& b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}
template <class T>
SOFTPOINT_INLINE Pack3<T> scaled(Pack<T> s, const Pack3<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
SOFTPOINT_INLINE Pack<T> larger(Pack<T> a, Pack<T> b) {
  return a > b ? a : b;
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

// The root of v, and `pull` over it: that to 14 bits with AVX-512, a function of v alone all the same, so
// that springs that are pulled by it keep an energy.
SOFTPOINT_INLINE Pack<float> length_of(Pack<float> v, Pack<float>& per_length) {
#if SOFTPOINT_KERNEL_BYTES == 64
  const Pack<float> y = _mm512_maskz_rsqrt14_ps(0xffff, v), t = v * y;
  per_length = y;
  return fma(0.5f * t, fma(-t, y, splat(1.0f)), t);
#else
  const Pack<float> root = sqrt(v);
  per_length = 1.0f / root;
  return root;
#endif
}
SOFTPOINT_INLINE Pack<double> length_of(Pack<double> v, Pack<double>& per_length) {
  const Pack<double> root = sqrt(v);
  per_length = 1.0 / root;
  return root;
}

// `now` one lane on, its first lane the last of `before`.
#if SOFTPOINT_KERNEL_BYTES == 64
SOFTPOINT_INLINE Pack<float> one_on(Pack<float> before, Pack<float> now) {
  return __builtin_shufflevector(before, now, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30);
}
SOFTPOINT_INLINE Pack<double> one_on(Pack<double> before, Pack<double> now) {
  return __builtin_shufflevector(before, now, 7, 8, 9, 10, 11, 12, 13, 14);
}
#elif SOFTPOINT_KERNEL_BYTES == 32
SOFTPOINT_INLINE Pack<float> one_on(Pack<float> before, Pack<float> now) {
  return __builtin_shufflevector(before, now, 7, 8, 9, 10, 11, 12, 13, 14);
}
SOFTPOINT_INLINE Pack<double> one_on(Pack<double> before, Pack<double> now) {
  return __builtin_shufflevector(before, now, 3, 4, 5, 6);
}
#else
SOFTPOINT_INLINE Pack<float> one_on(Pack<float> before, Pack<float> now) {
  return __builtin_shufflevector(before, now, 3, 4, 5, 6);
}
SOFTPOINT_INLINE Pack<double> one_on(Pack<double> before, Pack<double> now) {
  return __builtin_shufflevector(before, now, 1, 2);
}
#endif
template <class T>
SOFTPOINT_INLINE Pack3<T> one_on(const Pack3<T>& before, const Pack3<T>& now) {
  return {one_on(before.x, now.x), one_on(before.y, now.y), one_on(before.z, now.z)};
}

// What a step is the same for at all points.
template <class T>
struct MarchStep {
  T gauge, h, rate, unit_rate, damping;  // damping: of the change of a length, or of its speed in m/s
};

// Pull of the springs from the points at `at` along r, dampers included; `same`: where their stiffness is.
template <class T, bool kByLength>
SOFTPOINT_INLINE Pack3<T> pull_of(const MarchData<T>& d, const MarchStep<T>& step, int family, long at,
                                  long same, long offset, const Pack3<T>& r, const Pack3<T>& v) {
  const Pack<T> square = fma(r.x, r.x, fma(r.y, r.y, fma(r.z, r.z, splat(T(1e-30)))));
  Pack<T> per_length;
  const Pack<T> length = length_of(square, per_length);
  const Pack<T> stretch = length - d.rest[family];
  const Pack<T> elastic = larger<T>(stretch, d.compression * stretch);
  Pack<T> faster;
  if constexpr (kByLength) {
    faster = length - load(d.length[family] + at);
  } else {
    faster = dot<T>(load3(d.v[0], d.v[1], d.v[2], at + offset) - v, r) * per_length;
  }
  store(d.length[family] + at, length);
  const Pack<T> pull =
      load(d.stiffness[family] + same) * (fma(splat(step.damping), faster, elastic) * per_length);
  return scaled<T>(pull, r);
}

// Coulomb's friction and the push of the plane as forces, before anything is smoothed: what rests is in
// balance by the forces alone. Of a point that has come through its plane, a fifth of the way is taken back.
// `f` without contact becomes the change of v. `same`: where what does not change is.
template <class T>
SOFTPOINT_INLINE void meet(const MarchData<T>& d, const MarchStep<T>& step, long i, long same,
                           const Places3<T>& x, const Pack3<T>& v, Pack3<T> f) {
  const Pack<T> none = splat(T(0)), mass = load(d.mass + same), per_step = mass * step.rate;
  const Pack3<T> n = load3(d.normal[0], d.normal[1], d.normal[2], same);
  const Pack3<T> a = load3(d.acceleration[0], d.acceleration[1], d.acceleration[2], same);
  f = madd<T>(mass, madd<T>(splat(-d.drag_rate), v, a), f);
  const Pack<T> gap = dot<T>(way3<T>(x, places3<T>(d.foot, same)), n);
  const Pack<T> fall = fma(splat(step.unit_rate), larger<T>(T(0.2) * gap, gap), dot<T>(v, n));
  const Pack<T> push = -fma(per_step, fall, dot<T>(f, n));  // 0 where there is no plane
  const Mask<T> touches = push > none;
  Pack<T> touch = none;
  if (any<T>(touches)) {
    const Pack<T> pushed = touches ? push : none;
    f = madd<T>(pushed, n, f);
    const Pack3<T> whole = madd<T>(per_step, v, f);
    const Pack3<T> slip = madd<T>(-dot<T>(whole, n), n, whole);
    const Pack<T> limit = load(d.friction + same) * (pushed + load(d.adhesion + same));
    const Pack<T> square = dot<T>(slip, slip) + T(1e-30);
    const Mask<T> slides = square > limit * limit;
    const Pack<T> part = touches ? (slides ? -limit * inverse_length(square) : splat(T(-1))) : none;
    f = madd<T>(part, slip, f);
    const Pack3<T> contact = madd<T>(pushed, n, scaled<T>(part, slip));
    store3(d.c[0], d.c[1], d.c[2], i, contact + load3(d.c[0], d.c[1], d.c[2], i));
    touch = touches ? (slides ? splat(T(2)) : splat(T(1))) : none;
  }
  store(d.touch + i, touch);
  store3(d.f[0], d.f[1], d.f[2], i, scaled<T>(step.h * load(d.inverse_mass + same), f));
}

// Row by row; what a row gives to the one below waits in scratch.
template <class T, bool kByLength, MarchAir kAir>
SOFTPOINT_INLINE void push_rows(const MarchData<T>& d, const MarchStep<T>& step) {
  constexpr int kArrays = MarchData<T>::kRowArrays;
  const long s = d.stride, width = s + MarchData<T>::kPadding;
  T* here = d.scratch + kMarchLanes;
  T* below = here + kArrays * width;
  for (long i = -kMarchLanes; i < kArrays * width - kMarchLanes; ++i) below[i] = T(0);
  const auto put = [&](int array, long i, const Pack3<T>& a) {
    T* to = here + 3 * array * width;
    store3(to, to + width, to + 2 * width, i, a);
  };
  const auto get = [&](int array, long i) {
    const T* from = below + 3 * array * width;
    return load3(from, from + width, from + 2 * width, i);
  };
  for (long row = 0; row < d.rows; ++row) {
    const long begin = row * s;
    const bool inside = row > 0 && row + 1 < d.rows;
    const long points = inside && d.points_alike ? s : begin, springs = inside && d.springs_alike ? s : begin;
    Pack3<T> right_before{}, corner_before{};
    for (long i = 0; i < s; i += Of<T>::lanes) {
      const long at = begin + i;
      const Places3<T> x = places3<T>(d.x, at);
      const Pack3<T> v = load3(d.v[0], d.v[1], d.v[2], at);
      const Pack3<T> to_right = way3<T>(places3<T>(d.x, at + 1), x),
                     down = way3<T>(places3<T>(d.x, at + s), x),
                     across = way3<T>(places3<T>(d.x, at + s + 1), x),
                     back = way3<T>(places3<T>(d.x, at + s - 1), x);
      const Pack3<T> right = pull_of<T, kByLength>(d, step, 0, at, springs + i, 1, to_right, v);
      const Pack3<T> below_pull = pull_of<T, kByLength>(d, step, 1, at, springs + i, s, down, v);
      const Pack3<T> across_pull = pull_of<T, kByLength>(d, step, 2, at, springs + i, s + 1, across, v);
      const Pack3<T> back_pull = pull_of<T, kByLength>(d, step, 3, at, springs + i, s - 1, back, v);
      put(0, i, below_pull), put(1, i, across_pull), put(2, i, back_pull);
      Pack3<T> force = (right + below_pull) + (across_pull + back_pull) - one_on<T>(right_before, right) -
                       ((get(0, i) + get(1, i - 1)) + get(2, i + 1));
      right_before = right;
      if constexpr (kAir == MarchAir::kMeasured) {
        Pack3<T> abc = scaled<T>(load(d.faces[0] + at), cross<T>(to_right, across));
        Pack3<T> acd = scaled<T>(load(d.faces[1] + at), cross<T>(across, down));
        Pack3<T> a = abc + acd, b = abc, c = a, e = acd;
        if (d.crossed) {
          const Pack3<T> abd = scaled<T>(load(d.faces[2] + at), cross<T>(to_right, down));
          const Pack3<T> bcd = scaled<T>(load(d.faces[3] + at), cross<T>(across - to_right, down - to_right));
          a = a + abd, b = b + abd + bcd, c = c + bcd, e = e + abd + bcd;
        }
        put(3, i, c), put(4, i, e);
        const Pack3<T> g = (a + one_on<T>(corner_before, b)) + (get(3, i - 1) + get(4, i)) +
                           load3(d.rim[0], d.rim[1], d.rim[2], at);
        corner_before = b;
        store3(d.g[0], d.g[1], d.g[2], at, g);
        force = madd<T>(splat(step.gauge), g, force);
      } else if constexpr (kAir == MarchAir::kKept) {
        force = madd<T>(splat(step.gauge), load3(d.g[0], d.g[1], d.g[2], at), force);
      }
      meet<T>(d, step, at, points + i, x, v, force);
    }
    T* const other = here;
    here = below;
    below = other;
  }
}

template <class T, bool kByLength>
void push_air(const MarchData<T>& given, MarchAir air, const MarchStep<T>& same) {
  const MarchData<T> d = given;  // of which no store can be suspected to change the pointers
  const MarchStep<T> step = same;
  if (air == MarchAir::kMeasured) return push_rows<T, kByLength, MarchAir::kMeasured>(d, step);
  if (air == MarchAir::kKept) return push_rows<T, kByLength, MarchAir::kKept>(d, step);
  push_rows<T, kByLength, MarchAir::kNone>(d, step);
}

template <class T>
void push(const MarchData<T>& d, MarchAir air, MarchRate rate, T gauge, T h) {
  const bool by_length = rate == MarchRate::kLength;
  const MarchStep<T> step = {gauge, h, 1 / h, d.unit / h,
                             by_length ? d.damping_time / h : d.damping_time * d.per_unit};
  by_length ? push_air<T, true>(d, air, step) : push_air<T, false>(d, air, step);
}

// after all that it uses
#include "march_solve-inl.h"

constexpr MarchKernelTable kMarchKernels = {{push<float>, factor<float>, move<float>},
                                            {push<double>, factor<double>, move<double>},
                                            SOFTPOINT_KERNEL_BYTES};

}  // namespace

const MarchKernelTable* SOFTPOINT_KERNEL_NAME() { return &kMarchKernels; }

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

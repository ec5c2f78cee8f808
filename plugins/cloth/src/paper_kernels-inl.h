// The body of every paper_kernels_*.cpp: SOFTPOINT_PAPER_NAME and SOFTPOINT_PAPER_BYTES are set before.
#include "paper_kernels.h"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace softpoint::inline SOFTPOINT_ABI::cloth {
// Nameless, and the code calls nothing outside: no symbol but the table leaves this file.
namespace {

#define SOFTPOINT_PAPER_INLINE static inline __attribute__((always_inline))

template <class T>
struct Lanes;
template <>
struct Lanes<float> {
  typedef float Pack __attribute__((vector_size(SOFTPOINT_PAPER_BYTES)));
  typedef float Loose __attribute__((vector_size(SOFTPOINT_PAPER_BYTES), aligned(4), may_alias));
  static constexpr std::ptrdiff_t count = SOFTPOINT_PAPER_BYTES / 4;
};
template <>
struct Lanes<double> {
  typedef double Pack __attribute__((vector_size(SOFTPOINT_PAPER_BYTES)));
  typedef double Loose __attribute__((vector_size(SOFTPOINT_PAPER_BYTES), aligned(8), may_alias));
  static constexpr std::ptrdiff_t count = SOFTPOINT_PAPER_BYTES / 8;
};
template <class T>
using Pack = typename Lanes<T>::Pack;

template <class T>
SOFTPOINT_PAPER_INLINE Pack<T> load(const T* p) {
  return *reinterpret_cast<const typename Lanes<T>::Loose*>(p);
}
template <class T>
SOFTPOINT_PAPER_INLINE void store(T* p, Pack<T> v) {
  *reinterpret_cast<typename Lanes<T>::Loose*>(p) = v;
}

SOFTPOINT_PAPER_INLINE Pack<double> root(Pack<double> v) {
#if SOFTPOINT_PAPER_BYTES == 64
  return _mm512_maskz_sqrt_pd(0xff, v);  // the plain form warns in g++ 12
#elif SOFTPOINT_PAPER_BYTES == 32
  return _mm256_sqrt_pd(v);
#elif defined(__SSE2__)
  return _mm_sqrt_pd(v);
#else
  for (int i = 0; i < Lanes<double>::count; ++i) v[i] = __builtin_sqrt(v[i]);
  return v;
#endif
}
SOFTPOINT_PAPER_INLINE Pack<float> root(Pack<float> v) {
#if SOFTPOINT_PAPER_BYTES == 64
  return _mm512_maskz_sqrt_ps(0xffff, v);
#elif SOFTPOINT_PAPER_BYTES == 32
  return _mm256_sqrt_ps(v);
#elif defined(__SSE2__)
  return _mm_sqrt_ps(v);
#else
  for (int i = 0; i < Lanes<float>::count; ++i) v[i] = __builtin_sqrtf(v[i]);
  return v;
#endif
}

// 1/sqrt, to the last bits: with AVX-512 from its 14 bits, else by root and division, which all makers'
// processors round alike.
SOFTPOINT_PAPER_INLINE Pack<double> inverse_root(Pack<double> v) {
#if SOFTPOINT_PAPER_BYTES == 64
  Pack<double> y = _mm512_maskz_rsqrt14_pd(0xff, v);
  const Pack<double> half = 0.5 * v;
  y = y * (1.5 - half * y * y);
  return y * (1.5 - half * y * y);
#else
  return 1.0 / root(v);
#endif
}
SOFTPOINT_PAPER_INLINE Pack<float> inverse_root(Pack<float> v) {
#if SOFTPOINT_PAPER_BYTES == 64
  const Pack<float> y = _mm512_maskz_rsqrt14_ps(0xffff, v);
  return y * (1.5f - (0.5f * v) * y * y);
#else
  return 1.0f / root(v);
#endif
}

// a b + c, rounded once where the instruction set can.
SOFTPOINT_PAPER_INLINE Pack<double> fma(Pack<double> a, Pack<double> b, Pack<double> c) {
#if SOFTPOINT_PAPER_BYTES == 64
  return _mm512_fmadd_pd(a, b, c);
#elif SOFTPOINT_PAPER_BYTES == 32
  return _mm256_fmadd_pd(a, b, c);
#else
  return a * b + c;
#endif
}
SOFTPOINT_PAPER_INLINE Pack<float> fma(Pack<float> a, Pack<float> b, Pack<float> c) {
#if SOFTPOINT_PAPER_BYTES == 64
  return _mm512_fmadd_ps(a, b, c);
#elif SOFTPOINT_PAPER_BYTES == 32
  return _mm256_fmadd_ps(a, b, c);
#else
  return a * b + c;
#endif
}

// From point i to point i + offset.
template <class T>
SOFTPOINT_PAPER_INLINE Pack<T> arm(const PaperGrid<T>& g, int axis, std::ptrdiff_t i, std::ptrdiff_t offset) {
  Pack<T> d = load(g.x[axis] + i + offset) - load(g.x[axis] + i);
  if constexpr (sizeof(T) == 4) d += load(g.low[axis] + i + offset) - load(g.low[axis] + i);
  return d;
}

// Equation (3.6) for one family of springs along the row that begins at point `begin`.
template <class T>
SOFTPOINT_PAPER_INLINE void row_springs(const PaperGrid<T>& g, int family, std::ptrdiff_t offset,
                                        std::ptrdiff_t begin, T* out, std::ptrdiff_t width) {
  const Pack<T> zero = {};
  for (std::ptrdiff_t i = 0; i < g.stride; i += Lanes<T>::count) {
    const std::ptrdiff_t at = begin + i;
    const Pack<T> dx = arm(g, 0, at, offset), dy = arm(g, 1, at, offset), dz = arm(g, 2, at, offset);
    const Pack<T> square = fma(dx, dx, fma(dy, dy, dz * dz));
    const Pack<T> inverse = inverse_root(square);
    const Pack<T> stretch = square * inverse - g.rest[family];
    const Pack<T> k = load(g.stiffness[family] + at);
    const Pack<T> elastic = (stretch < zero ? k * g.compression_ratio : k) * stretch;
    const Pack<T> vx = load(g.v[0] + at + offset) - load(g.v[0] + at);
    const Pack<T> vy = load(g.v[1] + at + offset) - load(g.v[1] + at);
    const Pack<T> vz = load(g.v[2] + at + offset) - load(g.v[2] + at);
    const Pack<T> rate = fma(vx, dx, fma(vy, dy, vz * dz)) * inverse;
    const Pack<T> pull = fma(k * g.damping_time, rate, elastic) * inverse;
    store(out + i, pull * dx);
    store(out + width + i, pull * dy);
    store(out + 2 * width + i, pull * dz);
  }
}

// What the two triangles of each cell give to its corners a (i, j), b (i+1, j), c (i+1, j+1), d (i, j+1): a
// third of each triangle's area vector or, with `gradient`, the exact gradient of the volume under it.
template <class T, bool gradient>
SOFTPOINT_PAPER_INLINE void row_cells(const PaperGrid<T>& g, std::ptrdiff_t begin, T* out,
                                      std::ptrdiff_t width) {
  const std::ptrdiff_t s = g.stride;
  for (std::ptrdiff_t i = 0; i < s; i += Lanes<T>::count) {
    const std::ptrdiff_t at = begin + i;
    const Pack<T> slash = load(g.slash + at), backslash = load(g.backslash + at);  // a-c and b-d
    const Pack<T> za = load(g.x[2] + at), zb = load(g.x[2] + at + 1), zc = load(g.x[2] + at + s + 1),
                  zd = load(g.x[2] + at + s);
    const Pack<T> bx = arm(g, 0, at, 1), by = arm(g, 1, at, 1);
    const Pack<T> cx = arm(g, 0, at, s + 1), cy = arm(g, 1, at, s + 1);
    const Pack<T> dx = arm(g, 0, at, s), dy = arm(g, 1, at, s);
    T* const o = out + i;
    const auto give = [ o, width ](int corner, int axis, Pack<T> value) __attribute__((always_inline)) {
      store(o + (3 * corner + axis) * width, value);
    };
    // sixths of twice the shadows' areas
    const Pack<T> abc = slash * (bx * cy - by * cx), acd = slash * (cx * dy - cy * dx);
    const Pack<T> abd = backslash * (bx * dy - by * dx);
    const Pack<T> bcd = backslash * ((cx - bx) * (dy - by) - (cy - by) * (dx - bx));
    give(0, 2, abc + acd + abd);
    give(1, 2, abc + abd + bcd);
    give(2, 2, abc + acd + bcd);
    give(3, 2, acd + abd + bcd);
    if constexpr (gradient) {
      const Pack<T> habc = slash * (za + zb + zc), hacd = slash * (za + zc + zd);
      const Pack<T> habd = backslash * (za + zb + zd), hbcd = backslash * (zb + zc + zd);
      give(0, 0, habc * (by - cy) + hacd * (cy - dy) + habd * (by - dy));
      give(0, 1, habc * (cx - bx) + hacd * (dx - cx) + habd * (dx - bx));
      give(1, 0, habc * cy + habd * dy + hbcd * (cy - dy));
      give(1, 1, -habc * cx - habd * dx + hbcd * (dx - cx));
      give(2, 0, -habc * by + hacd * dy + hbcd * (dy - by));
      give(2, 1, habc * bx - hacd * dx + hbcd * (bx - dx));
      give(3, 0, -hacd * cy - habd * by + hbcd * (by - cy));
      give(3, 1, hacd * cx + habd * bx + hbcd * (cx - bx));
    } else {
      const Pack<T> bz = zb - za, cz = zc - za, dz = zd - za;
      const Pack<T> xabc = slash * (by * cz - bz * cy), xacd = slash * (cy * dz - cz * dy);
      const Pack<T> xabd = backslash * (by * dz - bz * dy);
      const Pack<T> xbcd = backslash * ((cy - by) * (dz - bz) - (cz - bz) * (dy - by));
      const Pack<T> yabc = slash * (bz * cx - bx * cz), yacd = slash * (cz * dx - cx * dz);
      const Pack<T> yabd = backslash * (bz * dx - bx * dz);
      const Pack<T> ybcd = backslash * ((cz - bz) * (dx - bx) - (cx - bx) * (dz - bz));
      give(0, 0, xabc + xacd + xabd);
      give(0, 1, yabc + yacd + yabd);
      give(1, 0, xabc + xabd + xbcd);
      give(1, 1, yabc + yabd + ybcd);
      give(2, 0, xabc + xacd + xbcd);
      give(2, 1, yabc + yacd + ybcd);
      give(3, 0, xacd + xabd + xbcd);
      give(3, 1, yacd + yabd + ybcd);
    }
  }
}

template <class T>
double forces(const PaperGrid<T>& grid) {
  const PaperGrid<T> g = grid;  // of which no store can be suspected to change the pointers
  constexpr int kFamilies = PaperGrid<T>::kFamilies, kArrays = PaperGrid<T>::kRowArrays;
  constexpr std::ptrdiff_t kLead = 16;  // zeros before each row: its left ghosts
  const std::ptrdiff_t s = g.stride, width = s + PaperGrid<T>::kPadding;
  const std::ptrdiff_t offset[kFamilies] = {1, s, s + 1, s - 1};
  const bool gradient = g.area_of_point == 0;
  T* here = g.scratch + kLead;
  T* below = here + kArrays * width;
  for (std::ptrdiff_t i = -kLead; i < kArrays * width - kLead; ++i) below[i] = 0;
  double volume = 0;
  for (std::ptrdiff_t row = 0; row < g.rows; ++row) {
    const std::ptrdiff_t begin = g.first + row * s;
    for (int f = 0; f < kFamilies; ++f) row_springs(g, f, offset[f], begin, here + 3 * f * width, width);
    T* const cells = here + 3 * kFamilies * width;
    if (gradient) {
      row_cells<T, true>(g, begin, cells, width);
    } else {
      row_cells<T, false>(g, begin, cells, width);
    }
    const T* const cells_below = below + 3 * kFamilies * width;
    Pack<T> row_volume = {};
    for (std::ptrdiff_t i = 0; i < s; i += Lanes<T>::count) {
      Pack<T> air[3];
      for (int axis = 0; axis < 3; ++axis) {
        const T *h = here + axis * width + i, *b = below + axis * width + i;
        store(g.force[axis] + begin + i, load(h) - load(h - 1) + (load(h + 3 * width) - load(b + 3 * width)) +
                                             (load(h + 6 * width) - load(b + 6 * width - 1)) +
                                             (load(h + 9 * width) - load(b + 9 * width + 1)));
        const T *q = cells + axis * width + i, *p = cells_below + axis * width + i;
        air[axis] = load(q) + load(q + 3 * width - 1) + (load(p + 6 * width - 1) + load(p + 9 * width));
      }
      row_volume += load(g.real_column + i) * air[2] * load(g.x[2] + begin + i);
      if (!gradient) {
        const Pack<T> square = fma(air[0], air[0], fma(air[1], air[1], air[2] * air[2]));
        const Pack<T> scale = g.area_of_point * inverse_root(square + T(1e-30));
        for (Pack<T>& a : air) a *= scale;
      }
      for (int axis = 0; axis < 3; ++axis) store(g.air[axis] + begin + i, air[axis]);
    }
    for (std::ptrdiff_t lane = 0; lane < Lanes<T>::count; ++lane) volume += row_volume[lane];
    T* const other = here;
    here = below;
    below = other;
  }
  return volume;
}

// The range from the first point to the last, ghosts between them included.
template <class T>
SOFTPOINT_PAPER_INLINE std::ptrdiff_t last(const PaperGrid<T>& g) {
  return g.first + g.rows * g.stride;
}

template <class T>
void accelerate(const PaperGrid<T>& grid, const PaperStep<T>& given) {
  const PaperGrid<T> g = grid;
  const PaperStep<T> step = given;
  const T kept = 1 - step.h * step.drag_rate;
  for (std::ptrdiff_t i = g.first; i < last(g); i += Lanes<T>::count) {
    const Pack<T> per_mass = step.h * load(g.inverse_mass + i), real = load(g.real + i);
    for (int axis = 0; axis < 3; ++axis) {
      const Pack<T> force = load(g.force[axis] + i) + step.gauge * load(g.air[axis] + i);
      const Pack<T> v = kept * load(g.v[axis] + i) + step.h * step.gravity[axis];
      store(g.v[axis] + i, real * fma(per_mass, force, v));
    }
  }
}

template <class T>
void move(const PaperGrid<T>& grid, const PaperStep<T>& given) {
  const PaperGrid<T> g = grid;
  const PaperStep<T> step = given;
  const Pack<T> zero = {}, one = zero + 1;
  const T rate = 1 / step.h;
  for (std::ptrdiff_t i = g.first; i < last(g); i += Lanes<T>::count) {
    Pack<T> v[3] = {load(g.v[0] + i), load(g.v[1] + i), load(g.v[2] + i)};
    const Pack<T> real = load(g.real + i);
    Pack<T> push = -rate * load(g.x[2] + i) - v[2];
    if constexpr (sizeof(T) == 4) push -= rate * load(g.low[2] + i);
    push = push > zero ? real * push : zero;
    Pack<T> limit = step.friction * push;
    if (step.friction_by_forces) {
      const Pack<T> force = load(g.force[2] + i) + step.gauge * load(g.air[2] + i);
      const Pack<T> pressed = -step.gravity[2] - force * load(g.inverse_mass + i);
      limit = pressed > zero ? step.friction * step.h * pressed : zero;
    }
    const Pack<T> slip = root(fma(v[0], v[0], v[1] * v[1]));
    Pack<T> part = slip > limit ? (slip - limit) / (slip > zero ? slip : one) : zero;
    part = push > zero ? part : one;
    v[0] *= part;
    v[1] *= part;
    v[2] += push;
    for (int axis = 0; axis < 3; ++axis) {
      store(g.v[axis] + i, v[axis]);
      const Pack<T> x = load(g.x[axis] + i);
      if constexpr (sizeof(T) == 4) {
        const Pack<T> add = fma(step.h + zero, v[axis], load(g.low[axis] + i));
        const Pack<T> sum = x + add;
        store(g.low[axis] + i, add - (sum - x));
        store(g.x[axis] + i, sum);
      } else {
        store(g.x[axis] + i, fma(step.h + zero, v[axis], x));
      }
    }
  }
}

constexpr PaperKernels kPaperKernels = {forces<float>,      forces<double>, accelerate<float>,
                                        accelerate<double>, move<float>,    move<double>};

}  // namespace

const PaperKernels* SOFTPOINT_PAPER_NAME() { return &kPaperKernels; }

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

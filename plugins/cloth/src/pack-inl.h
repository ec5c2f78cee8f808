// Vectors of numbers by GCC's vector extension: SOFTPOINT_KERNEL_BYTES wide, of floats or doubles. Included
// by sweep_kernels-inl.h only, inside a namespace of its own for each instruction set.

#define SOFTPOINT_INLINE static inline __attribute__((always_inline))
#define SOFTPOINT_MEMBER inline __attribute__((always_inline))

template <class T>
struct Of;
template <>
struct Of<float> {
  typedef float Pack __attribute__((vector_size(SOFTPOINT_KERNEL_BYTES)));
  typedef float Loose __attribute__((vector_size(SOFTPOINT_KERNEL_BYTES), aligned(4), may_alias));
  typedef int Mask __attribute__((vector_size(SOFTPOINT_KERNEL_BYTES)));
  static constexpr int lanes = SOFTPOINT_KERNEL_BYTES / 4;
};
template <>
struct Of<double> {
  typedef double Pack __attribute__((vector_size(SOFTPOINT_KERNEL_BYTES)));
  typedef double Loose __attribute__((vector_size(SOFTPOINT_KERNEL_BYTES), aligned(8), may_alias));
  typedef long long Mask __attribute__((vector_size(SOFTPOINT_KERNEL_BYTES)));
  static constexpr int lanes = SOFTPOINT_KERNEL_BYTES / 8;
};
template <class T>
using Pack = typename Of<T>::Pack;
template <class T>
using Mask = typename Of<T>::Mask;

template <class T>
SOFTPOINT_INLINE Pack<T> load(const T* p) {
  return *reinterpret_cast<const typename Of<T>::Loose*>(p);
}
template <class T>
SOFTPOINT_INLINE void store(T* p, Pack<T> v) {
  *reinterpret_cast<typename Of<T>::Loose*>(p) = v;
}
template <class T>
SOFTPOINT_INLINE Pack<T> splat(T v) {
  return v - Pack<T>{};
}
template <class T>
SOFTPOINT_INLINE Pack<T> gather(const T* p, const int* index) {
  Pack<T> out;
  for (int i = 0; i < Of<T>::lanes; ++i) out[i] = p[index[i]];
  return out;
}

// a b + c, rounded once where the instruction set can.
#if SOFTPOINT_KERNEL_BYTES == 64
SOFTPOINT_INLINE Pack<float> fma(Pack<float> a, Pack<float> b, Pack<float> c) {
  return _mm512_fmadd_ps(a, b, c);
}
SOFTPOINT_INLINE Pack<double> fma(Pack<double> a, Pack<double> b, Pack<double> c) {
  return _mm512_fmadd_pd(a, b, c);
}
// The plain forms warn in g++ 12.
SOFTPOINT_INLINE Pack<float> sqrt(Pack<float> v) { return _mm512_maskz_sqrt_ps(0xffff, v); }
SOFTPOINT_INLINE Pack<double> sqrt(Pack<double> v) { return _mm512_maskz_sqrt_pd(0xff, v); }
#elif SOFTPOINT_KERNEL_BYTES == 32
SOFTPOINT_INLINE Pack<float> fma(Pack<float> a, Pack<float> b, Pack<float> c) {
  return _mm256_fmadd_ps(a, b, c);
}
SOFTPOINT_INLINE Pack<double> fma(Pack<double> a, Pack<double> b, Pack<double> c) {
  return _mm256_fmadd_pd(a, b, c);
}
SOFTPOINT_INLINE Pack<float> sqrt(Pack<float> v) { return _mm256_sqrt_ps(v); }
SOFTPOINT_INLINE Pack<double> sqrt(Pack<double> v) { return _mm256_sqrt_pd(v); }
#else
SOFTPOINT_INLINE Pack<float> fma(Pack<float> a, Pack<float> b, Pack<float> c) { return a * b + c; }
SOFTPOINT_INLINE Pack<double> fma(Pack<double> a, Pack<double> b, Pack<double> c) { return a * b + c; }
#if defined(__SSE2__)
SOFTPOINT_INLINE Pack<float> sqrt(Pack<float> v) { return _mm_sqrt_ps(v); }
SOFTPOINT_INLINE Pack<double> sqrt(Pack<double> v) { return _mm_sqrt_pd(v); }
#else
SOFTPOINT_INLINE Pack<float> sqrt(Pack<float> v) {
  for (int i = 0; i < 4; ++i) v[i] = __builtin_sqrtf(v[i]);
  return v;
}
SOFTPOINT_INLINE Pack<double> sqrt(Pack<double> v) {
  for (int i = 0; i < 2; ++i) v[i] = __builtin_sqrt(v[i]);
  return v;
}
#endif
#endif

// 1/sqrt(v) to 2 ulp. In single by Newton's method from a guess by the bits: cheaper than a root and a
// quotient, and the same on every processor, which the approximate instructions are not.
SOFTPOINT_INLINE Pack<float> inverse_root(Pack<float> v) {
  const Pack<float> half = v * -0.5f;
  const Pack<float> threehalf = splat(1.5f);
  Pack<float> y = reinterpret_cast<Pack<float>>(0x5f375a86 - (reinterpret_cast<Mask<float>>(v) >> 1));
  y = y * fma(half * y, y, threehalf);
  y = y * fma(half * y, y, threehalf);
  return y * fma(half * y, y, threehalf);
}
SOFTPOINT_INLINE Pack<double> inverse_root(Pack<double> v) { return 1.0 / sqrt(v); }

template <class T>
SOFTPOINT_INLINE Pack<T> select(Mask<T> m, Pack<T> a, Pack<T> b) {
  return m ? a : b;
}
template <class T>
SOFTPOINT_INLINE Pack<T> max0(Pack<T> v) {
  return v > T(0) ? v : splat(T(0));
}
// In lane order, in double.
template <class T>
SOFTPOINT_INLINE double sum(Pack<T> v) {
  double s = 0;
  for (int i = 0; i < Of<T>::lanes; ++i) s += static_cast<double>(v[i]);
  return s;
}
template <class T>
SOFTPOINT_INLINE bool any(Mask<T> m) {
#if SOFTPOINT_KERNEL_BYTES == 64
  const __m512i bits = reinterpret_cast<__m512i>(m);
  return _mm512_test_epi64_mask(bits, bits) != 0;
#elif SOFTPOINT_KERNEL_BYTES == 32
  const __m256i bits = reinterpret_cast<__m256i>(m);
  return _mm256_testz_si256(bits, bits) == 0;
#elif defined(__SSE2__)
  return _mm_movemask_epi8(reinterpret_cast<__m128i>(m)) != 0;
#else
  typedef long long Words __attribute__((vector_size(SOFTPOINT_KERNEL_BYTES)));
  const Words w = reinterpret_cast<Words>(m);
  long long all = 0;
  for (int i = 0; i < SOFTPOINT_KERNEL_BYTES / 8; ++i) all |= w[i];
  return all != 0;
#endif
}

template <class T>
struct Pack3 {
  Pack<T> x, y, z;
};
template <class T>
SOFTPOINT_INLINE Pack3<T> load3(const T* x, const T* y, const T* z, long at) {
  return {load(x + at), load(y + at), load(z + at)};
}
template <class T>
SOFTPOINT_INLINE void store3(T* x, T* y, T* z, long at, const Pack3<T>& v) {
  store(x + at, v.x);
  store(y + at, v.y);
  store(z + at, v.z);
}
template <class T>
SOFTPOINT_INLINE Pack<T> dot(const Pack3<T>& a, const Pack3<T>& b) {
  return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}
template <class T>
SOFTPOINT_INLINE Pack3<T> operator-(const Pack3<T>& a, const Pack3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
SOFTPOINT_INLINE Pack3<T> operator+(const Pack3<T>& a, const Pack3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
// s a + b
template <class T>
SOFTPOINT_INLINE Pack3<T> madd(Pack<T> s, const Pack3<T>& a, const Pack3<T>& b) {
  return {fma(s, a.x, b.x), fma(s, a.y, b.y), fma(s, a.z, b.z)};
}

// Symmetric 3 x 3.
template <class T>
struct Sym3 {
  Pack<T> xx, yy, zz, xy, xz, yz;
};
template <class T>
SOFTPOINT_INLINE Pack3<T> times(const Sym3<T>& m, const Pack3<T>& v) {
  return {fma(m.xx, v.x, fma(m.xy, v.y, m.xz * v.z)), fma(m.xy, v.x, fma(m.yy, v.y, m.yz * v.z)),
          fma(m.xz, v.x, fma(m.yz, v.y, m.zz * v.z))};
}
// By L D L^T: cofactors would lose all digits in single when one direction is much stiffer than another.
template <class T>
SOFTPOINT_INLINE Sym3<T> inverse(const Sym3<T>& m) {
  const Pack<T> one = splat(T(1));
  const Pack<T> d0 = one / m.xx;
  const Pack<T> l10 = m.xy * d0, l20 = m.xz * d0;
  const Pack<T> d1 = one / (m.yy - l10 * m.xy);
  const Pack<T> e21 = m.yz - l20 * m.xy;
  const Pack<T> l21 = e21 * d1;
  const Pack<T> d2 = one / (m.zz - l20 * m.xz - l21 * e21);
  // Rows of L^-1: (1), (-l10, 1), (l10 l21 - l20, -l21, 1).
  const Pack<T> k20 = fma(l10, l21, -l20);
  Sym3<T> out;
  out.zz = d2;
  out.yz = -l21 * d2;
  out.xz = k20 * d2;
  out.yy = fma(l21 * l21, d2, d1);
  out.xy = -fma(k20 * l21, d2, l10 * d1);
  out.xx = fma(k20 * k20, d2, fma(l10 * l10, d1, d0));
  return out;
}

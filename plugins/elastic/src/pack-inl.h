// Vectors of kLanes doubles by GCC's vector extension, and the elementary functions the boundary
// integrals need. Included by kernels-inl.h only, inside a namespace of its own for each instruction set.

constexpr int kLanes = SOFTPOINT_KERNEL_LANES;
typedef double Pack __attribute__((vector_size(8 * kLanes)));
typedef long long Bits __attribute__((vector_size(8 * kLanes)));
typedef double LoosePack __attribute__((vector_size(8 * kLanes), aligned(8), may_alias));

#define SOFTPOINT_INLINE static inline __attribute__((always_inline))

SOFTPOINT_INLINE Pack load(const double* p) { return *reinterpret_cast<const LoosePack*>(p); }
SOFTPOINT_INLINE void store(double* p, Pack v) { *reinterpret_cast<LoosePack*>(p) = v; }
// Straight from memory: by an addition, as the vector extension would have it, it takes the place of a
// product.
SOFTPOINT_INLINE Pack splat(double v) {
#if SOFTPOINT_KERNEL_LANES == 8
  return _mm512_set1_pd(v);
#elif SOFTPOINT_KERNEL_LANES == 4
  return _mm256_set1_pd(v);
#else
  return Pack{v, v};
#endif
}
SOFTPOINT_INLINE Pack as_pack(Bits b) { return reinterpret_cast<Pack>(b); }
SOFTPOINT_INLINE Bits as_bits(Pack v) { return reinterpret_cast<Bits>(v); }

// a b + c, rounded once where the instruction set can.
SOFTPOINT_INLINE Pack fma(Pack a, Pack b, Pack c) {
#if SOFTPOINT_KERNEL_LANES == 8
  return _mm512_fmadd_pd(a, b, c);
#elif SOFTPOINT_KERNEL_LANES == 4
  return _mm256_fmadd_pd(a, b, c);
#else
  return a * b + c;
#endif
}

SOFTPOINT_INLINE Pack sqrt(Pack v) {
#if SOFTPOINT_KERNEL_LANES == 8
  return _mm512_maskz_sqrt_pd(0xff, v);  // the plain form warns in g++ 12
#elif SOFTPOINT_KERNEL_LANES == 4
  return _mm256_sqrt_pd(v);
#elif defined(__SSE2__)
  return _mm_sqrt_pd(v);
#else
  for (int i = 0; i < kLanes; ++i) v[i] = __builtin_sqrt(v[i]);
  return v;
#endif
}

SOFTPOINT_INLINE Pack abs(Pack v) { return as_pack(as_bits(v) & 0x7fffffffffffffffLL); }

// ln(num / den) for positive normal numbers, good to 2 ulp of the result even where it is near 0: with
// num/den = 2^e m, m in [1/sqrt 2, sqrt 2] and s = (m - 1)/(m + 1), it is e ln 2 + 2 artanh s. The
// polynomial is a Chebyshev fit of (artanh s / s - 1) / s^2, error 5e-18.
SOFTPOINT_INLINE Pack log_ratio(Pack num, Pack den) {
  constexpr long long kMantissa = 0x000fffffffffffffLL;
  constexpr long long kOne = 0x3ff0000000000000LL;
  constexpr long long kShifterBits = 0x4338000000000000LL;  // of 1.5 * 2^52: adds an integer to its mantissa
  constexpr double kShifter = 6755399441055744.0;
  const Bits exponent = (as_bits(num) >> 52) - (as_bits(den) >> 52);
  Pack e = as_pack(exponent + kShifterBits) - kShifter;
  Pack a = as_pack((as_bits(num) & kMantissa) | kOne);
  const Pack b = as_pack((as_bits(den) & kMantissa) | kOne);
  constexpr double kSqrt2 = 1.4142135623730951;
  const auto high = a > kSqrt2 * b;
  const auto low = kSqrt2 * a < b;
  a = high ? 0.5 * a : (low ? 2.0 * a : a);
  e = high ? e + 1.0 : (low ? e - 1.0 : e);
  const Pack s = (a - b) / (a + b);
  const Pack z = s * s;
  Pack p = splat(0.073082248425217029302);
  p = fma(p, z, splat(0.076658608002780206343));
  p = fma(p, z, splat(0.090914445626308610401));
  p = fma(p, z, splat(0.11111105567397539928));
  p = fma(p, z, splat(0.14285714312987742461));
  p = fma(p, z, splat(0.19999999999949752245));
  p = fma(p, z, splat(0.33333333333333348431));
  const Pack s2 = s + s;
  return fma(e, splat(0.69314718055994530942), fma(s2 * z, p, s2));
}

// The angle of (x, y) in [-pi, pi], to 2 ulp; 0 at the origin. Octant by symmetry, then tan(pi/4 - a) for
// slopes above tan(pi/8); Chebyshev fit of (atan t / t - 1) / t^2, error 5e-18.
SOFTPOINT_INLINE Pack angle(Pack y, Pack x) {
  constexpr double kPi = 3.14159265358979323846;
  const Pack ax = abs(x), ay = abs(y);
  const auto steep = ay > ax;
  const Pack lesser = steep ? ax : ay;
  const Pack greater = steep ? ay : ax;
  const auto far = lesser > 0.41421356237309503 * greater;
  const Pack num = far ? lesser - greater : lesser;
  Pack den = far ? lesser + greater : greater;
  den = den > 0.0 ? den : splat(1.0);
  const Pack t = num / den;
  const Pack z = t * t;
  Pack p = splat(-0.019176887119062258989);
  p = fma(p, z, splat(0.039231658295587191303));
  p = fma(p, z, splat(-0.050854497379402598613));
  p = fma(p, z, splat(0.058581489128022098816));
  p = fma(p, z, splat(-0.066645114473819480001));
  p = fma(p, z, splat(0.076921831908260865637));
  p = fma(p, z, splat(-0.090909045781239018905));
  p = fma(p, z, splat(0.11111111015256361727));
  p = fma(p, z, splat(-0.14285714284666542922));
  p = fma(p, z, splat(0.19999999999995520678));
  p = fma(p, z, splat(-0.3333333333333333016));
  Pack a = fma(t * z, p, t);
  a = far ? a + kPi / 4 : a;
  a = steep ? kPi / 2 - a : a;
  a = x < 0.0 ? kPi - a : a;
  return as_pack(as_bits(a) | (as_bits(y) & static_cast<long long>(0x8000000000000000ULL)));
}

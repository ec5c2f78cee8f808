// c = a b with a packed once and used often: a few hundred rows and columns, b of one to a thousand columns.
// Included by kernels-inl.h only.

typedef float SinglePack __attribute__((vector_size(8 * kLanes)));
typedef float LooseSinglePack __attribute__((vector_size(8 * kLanes), aligned(4), may_alias));

SOFTPOINT_INLINE SinglePack load(const float* p) { return *reinterpret_cast<const LooseSinglePack*>(p); }
SOFTPOINT_INLINE void store(float* p, SinglePack v) { *reinterpret_cast<LooseSinglePack*>(p) = v; }
SOFTPOINT_INLINE SinglePack splat(float v) {
#if SOFTPOINT_KERNEL_LANES == 8
  return _mm512_set1_ps(v);
#elif SOFTPOINT_KERNEL_LANES == 4
  return _mm256_set1_ps(v);
#else
  return SinglePack{v, v, v, v};
#endif
}

SOFTPOINT_INLINE SinglePack fma(SinglePack a, SinglePack b, SinglePack c) {
#if SOFTPOINT_KERNEL_LANES == 8
  return _mm512_fmadd_ps(a, b, c);
#elif SOFTPOINT_KERNEL_LANES == 4
  return _mm256_fmadd_ps(a, b, c);
#else
  return a * b + c;
#endif
}

template <class Real>
struct PackOf;
template <>
struct PackOf<float> {
  using Type = SinglePack;
};
template <>
struct PackOf<double> {
  using Type = Pack;
};

// A strip of `a` is kProductPacks registers high; so many columns of `b` are taken at a time.
constexpr int kProductPacks = 2;
#if SOFTPOINT_KERNEL_LANES == 8
constexpr int kProductColumns = 12;
#else
constexpr int kProductColumns = 6;
#endif
template <class Real>
constexpr Index kStripRows = kProductPacks * 8 * kLanes / static_cast<Index>(sizeof(Real));

// Numbers of `b` that are packed side by side on the stack, for tiles of any depth in use.
constexpr Index kPackedDepth = 640;

// c = a b for one strip of `a` and a few columns of `b`, whose rows are kProductColumns apart. Each element
// is one sum over the depth, in its order, whatever the columns beside it.
template <class Real, int columns>
__attribute__((noinline)) void product_tile(const Real* a, Index depth, const Real* b, Real* c, Index ldc,
                                            bool add) {
  using Wide = typename PackOf<Real>::Type;
  constexpr Index kWidth = kStripRows<Real> / kProductPacks;
  Wide sum[columns][kProductPacks];
#pragma GCC unroll 12
  for (int j = 0; j < columns; ++j) {
#pragma GCC unroll 2
    for (int i = 0; i < kProductPacks; ++i) sum[j][i] = add ? load(c + j * ldc + i * kWidth) : Wide{};
  }
  for (Index p = 0; p < depth; ++p) {
    Wide row[kProductPacks];
#pragma GCC unroll 2
    for (int i = 0; i < kProductPacks; ++i) row[i] = load(a + i * kWidth);
#pragma GCC unroll 12
    for (int j = 0; j < columns; ++j) {
      const Wide s = splat(b[j]);
#pragma GCC unroll 2
      for (int i = 0; i < kProductPacks; ++i) sum[j][i] = fma(row[i], s, sum[j][i]);
    }
    a += kStripRows<Real>;
    b += kProductColumns;
  }
#pragma GCC unroll 12
  for (int j = 0; j < columns; ++j) {
#pragma GCC unroll 2
    for (int i = 0; i < kProductPacks; ++i) store(c + j * ldc + i * kWidth, sum[j][i]);
  }
}

template <class Real, int columns>
void product_tiles(Index used, const Real* a, Index depth, const Real* b, Real* c, Index ldc, bool add) {
  if constexpr (columns > 1) {
    if (used < columns) {
      product_tiles<Real, columns - 1>(used, a, depth, b, c, ldc, add);
      return;
    }
  }
  product_tile<Real, columns>(a, depth, b, c, ldc, add);
}

template <class Real>
void block_product(const Real* packed, Index strips, Index depth, const Real* b, Index ldb, Index n, Real* c,
                   Index ldc) {
  Real rows[kPackedDepth * kProductColumns];
  const Index tiles = (n + kProductColumns - 1) / kProductColumns;
  for (Index t = 0; t < tiles; ++t) {
    const Index first = n * t / tiles, used = n * (t + 1) / tiles - first;
    for (Index from = 0; from < depth; from += kPackedDepth) {
      const Index part = depth - from < kPackedDepth ? depth - from : kPackedDepth;
      for (Index j = 0; j < used; ++j) {
        const Real* const column = b + (first + j) * ldb + from;
        for (Index p = 0; p < part; ++p) rows[p * kProductColumns + j] = column[p];
      }
      for (Index s = 0; s < strips; ++s) {
        product_tiles<Real, kProductColumns>(used, packed + (s * depth + from) * kStripRows<Real>, part, rows,
                                             c + s * kStripRows<Real> + first * ldc, ldc, from > 0);
      }
    }
  }
}

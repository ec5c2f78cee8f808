// y = a x with a symmetric, of which each element below the diagonal is read from memory once: it serves its
// row and its column. Included by kernels-inl.h only.

template <class Real>
SOFTPOINT_INLINE Real sum_of(typename PackOf<Real>::Type v) {
  Real sum = 0;
  for (unsigned i = 0; i < sizeof(v) / sizeof(Real); ++i) sum += v[i];
  return sum;
}

template <class Real>
void symmetric_product(const Real* a, Index n, Index lda, const Real* x, Real* y) {
  using Wide = typename PackOf<Real>::Type;
  constexpr Index kWidth = static_cast<Index>(sizeof(Wide) / sizeof(Real));
  constexpr int kPanel = 4;
  for (Index i = 0; i < n; ++i) y[i] = 0;
  Index j = 0;
  for (; j + kPanel <= n; j += kPanel) {
    const Real* column[kPanel];
    Wide across[kPanel], down[kPanel];
    Real rest[kPanel];
#pragma GCC unroll 4
    for (int k = 0; k < kPanel; ++k) {
      column[k] = a + (j + k) * lda;
      across[k] = splat(x[j + k]);
      down[k] = Wide{};
      rest[k] = 0;
    }
    for (Index r = 0; r < kPanel; ++r) {  // the block on the diagonal
      for (Index k = 0; k < kPanel; ++k) {
        y[j + r] += (r >= k ? column[k][j + r] : column[r][j + k]) * x[j + k];
      }
    }
    Index i = j + kPanel;
    for (; i + kWidth <= n; i += kWidth) {
      Wide sum = load(y + i);
      const Wide at = load(x + i);
#pragma GCC unroll 4
      for (int k = 0; k < kPanel; ++k) {
        const Wide c = load(column[k] + i);
        sum = fma(c, across[k], sum);
        down[k] = fma(c, at, down[k]);
      }
      store(y + i, sum);
    }
    for (; i < n; ++i) {
      for (int k = 0; k < kPanel; ++k) {
        y[i] += column[k][i] * x[j + k];
        rest[k] += column[k][i] * x[i];
      }
    }
    for (int k = 0; k < kPanel; ++k) y[j + k] += sum_of<Real>(down[k]) + rest[k];
  }
  for (; j < n; ++j) {
    y[j] += a[j + j * lda] * x[j];
    for (Index i = j + 1; i < n; ++i) {
      y[i] += a[i + j * lda] * x[j];
      y[j] += a[i + j * lda] * x[i];
    }
  }
}

// y = a x with a symmetric, of which each element below the diagonal is read from memory once: it serves its
// row and its column. Included by kernels-inl.h only.

template <class Wide>
SOFTPOINT_INLINE auto sum_of(Wide v) {
  auto sum = v[0];
  for (unsigned i = 1; i < sizeof(v) / sizeof(v[0]); ++i) sum += v[i];
  return sum;
}

constexpr int kSymmetricPanel = 4;

// The memory it streams through is all its time: panel after panel without gaps, as symmetric_layout.h lays
// them out.
void packed_symmetric_product(const float* a, Index n, const float* x, float* y) {
  constexpr Index kWidth = static_cast<Index>(sizeof(SinglePack) / sizeof(float));
  const float* const diagonal = a;
  a += (n + kWidth - 1) / kWidth * kWidth;
  for (Index i = 0; i < n; i += kWidth) store(y + i, load(diagonal + i) * load(x + i));
  for (Index j = 0; j < n; j += kSymmetricPanel) {
    SinglePack across[kSymmetricPanel], down[kSymmetricPanel];
#pragma GCC unroll 4
    for (int k = 0; k < kSymmetricPanel; ++k) {
      across[k] = splat(x[j + k]);
      down[k] = SinglePack{};
    }
    for (Index i = j; i < n; i += kWidth, a += kSymmetricPanel * kWidth) {
      SinglePack even = load(y + i), odd = SinglePack{};
      const SinglePack at = load(x + i);
#pragma GCC unroll 4
      for (int k = 0; k < kSymmetricPanel; ++k) {
        const SinglePack c = load(a + k * kWidth);
        SinglePack& sum = k % 2 == 0 ? even : odd;
        sum = fma(c, across[k], sum);
        down[k] = fma(c, at, down[k]);
      }
      store(y + i, even + odd);
    }
    for (int k = 0; k < kSymmetricPanel; ++k) y[j + k] += sum_of(down[k]);
  }
}

void symmetric_product(const double* a, Index n, Index lda, const double* x, double* y) {
  constexpr Index kWidth = static_cast<Index>(sizeof(Pack) / sizeof(double));
  constexpr int kPanel = kSymmetricPanel;
  for (Index i = 0; i < n; ++i) y[i] = 0;
  Index j = 0;
  for (; j + kPanel <= n; j += kPanel) {
    const double* column[kPanel];
    Pack across[kPanel], down[kPanel];
    double rest[kPanel];
#pragma GCC unroll 4
    for (int k = 0; k < kPanel; ++k) {
      column[k] = a + (j + k) * lda;
      across[k] = splat(x[j + k]);
      down[k] = Pack{};
      rest[k] = 0;
    }
    for (Index r = 0; r < kPanel; ++r) {  // the block on the diagonal
      for (Index k = 0; k < kPanel; ++k) {
        y[j + r] += (r >= k ? column[k][j + r] : column[r][j + k]) * x[j + k];
      }
    }
    Index i = j + kPanel;
    for (; i + kWidth <= n; i += kWidth) {
      Pack sum = load(y + i);
      const Pack at = load(x + i);
#pragma GCC unroll 4
      for (int k = 0; k < kPanel; ++k) {
        const Pack c = load(column[k] + i);
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
    for (int k = 0; k < kPanel; ++k) y[j + k] += sum_of(down[k]) + rest[k];
  }
  for (; j < n; ++j) {
    y[j] += a[j + j * lda] * x[j];
    for (Index i = j + 1; i < n; ++i) {
      y[i] += a[i + j * lda] * x[j];
      y[j] += a[i + j * lda] * x[i];
    }
  }
}

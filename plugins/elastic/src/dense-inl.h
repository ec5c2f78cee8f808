// Blocked dense algebra, column-major: one packed matrix product, and the recursive Cholesky factor,
// triangular divisions and symmetric square that rest on it. Included by kernels-inl.h only.

using Index = std::ptrdiff_t;

// A tile of kPacks x kLanes rows and kTileColumns columns stays in registers.
#if SOFTPOINT_KERNEL_LANES == 8
constexpr int kPacks = 3, kTileColumns = 8;
#elif SOFTPOINT_KERNEL_LANES == 4
constexpr int kPacks = 3, kTileColumns = 4;
#else
constexpr int kPacks = 2, kTileColumns = 4;
#endif
constexpr Index kTileRows = kPacks * kLanes;
constexpr Index kDepth = 256;      // columns of a packed block
constexpr Index kRows = 6 * 24;    // its rows: 295 kB, for the second-level cache
constexpr Index kColumns = 512;    // columns of C at a time
constexpr Index kLeaf = 16;        // where the recursions end
constexpr Index kSquareLeaf = 96;  // blocks of add_square on the diagonal
static_assert(kRows % kTileRows == 0 && kColumns % kTileColumns == 0);

// n x k matrix with any strides, so that a transpose costs nothing.
struct View {
  const double* at;
  Index row, column;
};

// tile (kTileRows x kTileColumns) = sum over p of a_p b_p^T.
__attribute__((noinline)) void multiply_tile(Index depth, const double* a, const double* b, double* tile) {
  Pack sum[kTileColumns][kPacks] = {};
  for (Index p = 0; p < depth; ++p) {
    Pack row[kPacks];
#pragma GCC unroll 3
    for (int i = 0; i < kPacks; ++i) row[i] = load(a + i * kLanes);
#pragma GCC unroll 8
    for (int j = 0; j < kTileColumns; ++j) {
      const Pack s = splat(b[j]);
#pragma GCC unroll 3
      for (int i = 0; i < kPacks; ++i) sum[j][i] = fma(row[i], s, sum[j][i]);
    }
    a += kTileRows;
    b += kTileColumns;
  }
#pragma GCC unroll 8
  for (int j = 0; j < kTileColumns; ++j) {
#pragma GCC unroll 3
    for (int i = 0; i < kPacks; ++i) store(tile + j * kTileRows + i * kLanes, sum[j][i]);
  }
}

// Strips of `width` rows, depth-major inside, padded with zeros.
void pack_strips(View a, Index rows, Index depth, Index width, double* out) {
  for (Index first = 0; first < rows; first += width) {
    const Index used = rows - first < width ? rows - first : width;
    const double* from = a.at + first * a.row;
    for (Index p = 0; p < depth; ++p, from += a.column, out += width) {
      for (Index i = 0; i < used; ++i) out[i] = from[i * a.row];
      for (Index i = used; i < width; ++i) out[i] = 0.0;
    }
  }
}

void add_tile(const double* tile, Index rows, Index columns, double sign, double* c, Index ldc) {
  if (rows == kTileRows) {
    for (Index j = 0; j < columns; ++j) {
      for (Index i = 0; i < kTileRows; i += kLanes) {
        double* to = c + i + j * ldc;
        store(to, load(to) + sign * load(tile + i + j * kTileRows));
      }
    }
  } else {
    for (Index j = 0; j < columns; ++j) {
      for (Index i = 0; i < rows; ++i) c[i + j * ldc] += sign * tile[i + j * kTileRows];
    }
  }
}

// c (m x n) += sign a b^T, a being m x k and b n x k.
void multiply(Index m, Index n, Index k, double sign, View a, View b, double* c, Index ldc, double* scratch) {
  double* const packed_a = scratch;
  double* const packed_b = scratch + kRows * kDepth;
  double tile[kTileRows * kTileColumns];
  for (Index p = 0; p < k; p += kDepth) {
    const Index depth = k - p < kDepth ? k - p : kDepth;
    for (Index j = 0; j < n; j += kColumns) {
      const Index columns = n - j < kColumns ? n - j : kColumns;
      pack_strips({b.at + j * b.row + p * b.column, b.row, b.column}, columns, depth, kTileColumns, packed_b);
      for (Index i = 0; i < m; i += kRows) {
        const Index rows = m - i < kRows ? m - i : kRows;
        pack_strips({a.at + i * a.row + p * a.column, a.row, a.column}, rows, depth, kTileRows, packed_a);
        for (Index y = 0; y < columns; y += kTileColumns) {
          for (Index x = 0; x < rows; x += kTileRows) {
            multiply_tile(depth, packed_a + x * depth, packed_b + y * depth, tile);
            add_tile(tile, rows - x < kTileRows ? rows - x : kTileRows,
                     columns - y < kTileColumns ? columns - y : kTileColumns, sign,
                     c + (i + x) + (j + y) * ldc, ldc);
          }
        }
      }
    }
  }
}

// Where a recursion over n > kLeaf splits: about half, whole leaves.
Index half(Index n) { return (n / 2 + kLeaf - 1) / kLeaf * kLeaf; }

// c += sign a a^T, lower triangle.
void square(double* c, Index n, Index ldc, double sign, const double* a, Index k, Index lda,
            double* scratch) {
  if (n <= kSquareLeaf) {
    multiply(n, n, k, sign, {a, 1, lda}, {a, 1, lda}, c, ldc, scratch);
    return;
  }
  const Index h = half(n);
  square(c, h, ldc, sign, a, k, lda, scratch);
  multiply(n - h, h, k, sign, {a + h, 1, lda}, {a, 1, lda}, c + h, ldc, scratch);
  square(c + h + h * ldc, n - h, ldc, sign, a + h, k, lda, scratch);
}

// x <- x L^-T (transposed) or x L^-1, n <= kLeaf columns, for kLanes rows at a time and then one by one.
template <class Row, bool transposed>
SOFTPOINT_INLINE void divide_row(double* x, Index ldx, const double* l, Index n, Index ldl) {
  Row v[kLeaf];
  const auto read = [&](Index j) {
    if constexpr (sizeof(Row) == sizeof(double)) {
      return x[j * ldx];
    } else {
      return load(x + j * ldx);
    }
  };
  for (Index step = 0; step < n; ++step) {
    const Index j = transposed ? step : n - 1 - step;
    Row t = read(j);
    for (Index q = 0; q < step; ++q) {
      const Index p = transposed ? q : n - 1 - q;
      t -= v[p] * (transposed ? l[j + p * ldl] : l[p + j * ldl]);
    }
    v[j] = t / l[j + j * ldl];
    if constexpr (sizeof(Row) == sizeof(double)) {
      x[j * ldx] = v[j];
    } else {
      store(x + j * ldx, v[j]);
    }
  }
}

template <bool transposed>
void divide_leaf(double* x, Index m, Index ldx, const double* l, Index n, Index ldl) {
  Index i = 0;
  for (; i + kLanes <= m; i += kLanes) divide_row<Pack, transposed>(x + i, ldx, l, n, ldl);
  for (; i < m; ++i) divide_row<double, transposed>(x + i, ldx, l, n, ldl);
}

void divide_transposed(double* x, Index m, Index ldx, const double* l, Index n, Index ldl, double* scratch) {
  if (n <= kLeaf) {
    divide_leaf<true>(x, m, ldx, l, n, ldl);
    return;
  }
  const Index h = half(n);
  divide_transposed(x, m, ldx, l, h, ldl, scratch);
  multiply(m, n - h, h, -1.0, {x, 1, ldx}, {l + h, 1, ldl}, x + h * ldx, ldx, scratch);
  divide_transposed(x + h * ldx, m, ldx, l + h + h * ldl, n - h, ldl, scratch);
}

void divide(double* x, Index m, Index ldx, const double* l, Index n, Index ldl, double* scratch) {
  if (n <= kLeaf) {
    divide_leaf<false>(x, m, ldx, l, n, ldl);
    return;
  }
  const Index h = half(n);
  divide(x + h * ldx, m, ldx, l + h + h * ldl, n - h, ldl, scratch);
  multiply(m, h, n - h, -1.0, {x + h * ldx, 1, ldx}, {l + h, ldl, 1}, x, ldx, scratch);
  divide(x, m, ldx, l, h, ldl, scratch);
}

bool cholesky_leaf(double* a, Index n, Index lda) {
  for (Index j = 0; j < n; ++j) {
    for (Index p = 0; p < j; ++p) {
      for (Index i = j; i < n; ++i) a[i + j * lda] -= a[i + p * lda] * a[j + p * lda];
    }
    if (!(a[j + j * lda] > 0.0)) return false;
    a[j + j * lda] = __builtin_sqrt(a[j + j * lda]);
    for (Index i = j + 1; i < n; ++i) a[i + j * lda] /= a[j + j * lda];
  }
  return true;
}

bool cholesky(double* a, Index n, Index lda, double* scratch) {
  if (n <= kLeaf) return cholesky_leaf(a, n, lda);
  const Index h = half(n);
  if (!cholesky(a, h, lda, scratch)) return false;
  divide_transposed(a + h, n - h, lda, a, h, lda, scratch);
  square(a + h + h * lda, n - h, lda, -1.0, a + h, h, lda, scratch);
  return cholesky(a + h + h * lda, n - h, lda, scratch);
}

void add_square(double* s, Index m, Index lds, const double* x, Index n, Index ldx, double* scratch) {
  square(s, m, lds, 1.0, x, n, ldx, scratch);
}

void add_product(Index m, Index n, Index k, double sign, const double* a, Index a_row, Index a_column,
                 const double* b, Index b_row, Index b_column, double* c, Index ldc, double* scratch) {
  multiply(m, n, k, sign, {a, a_row, a_column}, {b, b_row, b_column}, c, ldc, scratch);
}

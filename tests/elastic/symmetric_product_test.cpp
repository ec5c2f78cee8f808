// The product of each step's response, against sums in double precision, by every instruction set there is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "instruction_set.h"
#include "symmetric_layout.h"

namespace softpoint::elastic {
namespace {

constexpr InstructionSet kSets[] = {InstructionSet::kBaseline, InstructionSet::kAvx2,
                                    InstructionSet::kAvx512};

double entry(std::size_t i, std::size_t j) {
  const auto low = static_cast<double>(std::min(i, j)), high = static_cast<double>(std::max(i, j));
  return std::sin(1.0 + 1.3 * low + 0.7 * high);
}

// Whole strips, parts of them, panels cut short, one number.
class SymmetricProduct : public testing::TestWithParam<std::size_t> {};

TEST_P(SymmetricProduct, AgreesWithTheDenseSumInEveryInstructionSet) {
  const std::size_t n = GetParam();
  std::vector<double> a(n * n), x(n), right(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) x[i] = std::cos(2.1 * static_cast<double>(i));
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      a[i + j * n] = entry(i, j);
      right[i] += a[i + j * n] * x[j];
    }
  }
  for (const InstructionSet set : kSets) {
    if (set > best_instruction_set()) continue;
    const Kernels& kernels = kernels_for(set);
    const auto size = static_cast<std::ptrdiff_t>(n);
    std::vector<float> in(n + kSymmetricPadding, 0.0F), out(n + kSymmetricPadding, NAN);
    std::copy(x.begin(), x.end(), in.begin());
    const std::vector<float> packed = pack_symmetric(kernels, a, size);
    EXPECT_LT(static_cast<double>(packed.size()),
              0.5 * static_cast<double>(n * n) + static_cast<double>(12 * (n + 16)));
    kernels.packed_symmetric_single(packed.data(), size, in.data(), out.data());
    std::vector<double> dense(n, NAN);
    kernels.symmetric_double(a.data(), size, size, x.data(), dense.data());
    const double terms = std::sqrt(static_cast<double>(n));
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(out[i], right[i], 4e-7 * terms) << name(set) << ", row " << i;
      EXPECT_NEAR(dense[i], right[i], 1e-14 * terms) << name(set) << ", row " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, SymmetricProduct, testing::Values(1, 3, 4, 15, 16, 17, 63, 78, 246),
                         [](const auto& size) { return std::to_string(size.param); });

}  // namespace
}  // namespace softpoint::elastic

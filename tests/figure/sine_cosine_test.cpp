#include "sine_cosine-inl.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace softpoint::figure {
namespace {

TEST(SineCosine, AgreesWithTheLibrary) {
  std::mt19937 random(5);
  double worst = 0;
  for (const double range : {0.1, 1.0, 7.0, 100.0, 1e4, 6e6}) {
    std::uniform_real_distribution<double> angle(-range, range);
    for (int i = 0; i < 100000; ++i) {
      const double x = angle(random);
      double s = 0, c = 0;
      sine_cosine(x, s, c);
      worst = std::max({worst, std::abs(s - std::sin(x)), std::abs(c - std::cos(x))});
    }
  }
  for (int quarter = -20; quarter <= 20; ++quarter) {  // the joins of the pieces
    for (const double nudge : {-1e-15, 0.0, 1e-15, 0.785398163397448, 0.785398163397449}) {
      const double x = quarter * 1.5707963267948966 + nudge;
      double s = 0, c = 0;
      sine_cosine(x, s, c);
      worst = std::max({worst, std::abs(s - std::sin(x)), std::abs(c - std::cos(x))});
    }
  }
  std::printf("    off by %.1e\n", worst);
  EXPECT_LE(worst, 1e-15);
}

}  // namespace
}  // namespace softpoint::figure

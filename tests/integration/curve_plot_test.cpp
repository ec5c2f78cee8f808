// Curves over time as pictures.
#include "curve_plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace softpoint::scene {
namespace {

TEST(CurvePlot, TicksAreRoundAndFew) {
  for (const double scale : {1e-9, 1e-3, 0.7, 1.0, 3.0, 42.0, 1e6}) {
    for (const double low : {-scale, 0.0, 0.3 * scale}) {
      const std::vector<double> ticks = round_ticks(low, low + scale);
      ASSERT_GE(ticks.size(), 3u);
      EXPECT_LE(ticks.size(), 11u);
      const double spacing = ticks[1] - ticks[0];
      const double lead = spacing / std::pow(10.0, std::floor(std::log10(spacing * (1 + 1e-9))));
      EXPECT_TRUE(std::abs(lead - 1) < 1e-6 || std::abs(lead - 2) < 1e-6 || std::abs(lead - 5) < 1e-6)
          << lead;
      for (const double tick : ticks) {
        EXPECT_GE(tick, low - 1e-6 * scale);
        EXPECT_LE(tick, low + scale * (1 + 1e-6));
        EXPECT_FALSE(tick == 0.0 && std::signbit(tick));
      }
    }
  }
}

// Rows of each column of pixels whose colour is that of the first curve.
std::vector<double> traced(const picture::Image& image) {
  std::vector<double> heights;
  for (int x = 100; x < 880; ++x) {
    double sum = 0, count = 0;
    for (int y = 27; y < 176; ++y) {
      const auto* p = image.pixel(x, y);
      if (p[0] > p[2] + 30) {  // the palette's first colour is warm
        sum += y;
        count += 1;
      }
    }
    heights.push_back(count > 0 ? sum / count : -1);
  }
  return heights;
}

TEST(CurvePlot, DrawsWhatItIsGiven) {
  std::vector<double> times, rising;
  for (int i = 0; i <= 100; ++i) {
    times.push_back(i / 100.0);
    rising.push_back(i);
  }
  const std::vector<double> heights = traced(draw_curves(times, {{"rising", {{"", rising}}}}));
  for (std::size_t x = 1; x < heights.size(); ++x) {
    ASSERT_GT(heights[x], 0) << "no gap";
    EXPECT_LE(heights[x], heights[x - 1] + 0.5);
  }
  EXPECT_NEAR(heights.front() - heights.back(), 140, 20) << "over most of the panel's height";
}

TEST(CurvePlot, LeavesGapsWhereThereIsNoNumberAndTakesAnyRange) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> times{0, 0.25, 0.5, 0.75, 1};
  const std::vector<double> heights = traced(draw_curves(times, {{"gap", {{"", {1, 1, none, 1, 1}}}}}));
  EXPECT_LT(heights[heights.size() / 2], 0);
  EXPECT_GT(heights[heights.size() / 10], 0);
  for (const auto& values : std::vector<std::vector<double>>{
           {}, {none, none}, {0, 0, 0}, {5}, {-1e300, 1e300}, {1e-300, 2e-300}, {1e9, 1e9 + 1e-3}}) {
    const picture::Image image = draw_curves(times, {{"any", {{"a", values}, {"b", {}}}}, {"none", {}}});
    EXPECT_EQ(image.width, 900);
    EXPECT_EQ(image.height, 2 * 190 + 22);
  }
  EXPECT_EQ(draw_curves({}, {{"empty", {{"", {}}}}}).width, 900);
}

}  // namespace
}  // namespace softpoint::scene

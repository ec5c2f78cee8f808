#include "softpoint/core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "support/field_table.h"
#include "support/refusal.h"

namespace softpoint {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(Error, NamesFieldValueAndRange) {
  const std::string message = refusal([] { check_range("friction", 1.5, 0.0, 1.0); });
  EXPECT_NE(message.find("friction"), std::string::npos) << message;
  EXPECT_NE(message.find("1.5"), std::string::npos) << message;
  EXPECT_NE(message.find("0 to 1"), std::string::npos) << message;
}

TEST(Error, RangeIncludesItsEnds) {
  EXPECT_NO_THROW(check_range("x", 0.0, 0.0, 1.0));
  EXPECT_NO_THROW(check_range("x", 1.0, 0.0, 1.0));
  EXPECT_THROW(check_range("x", std::nextafter(1.0, 2.0), 0.0, 1.0), Error);
  EXPECT_THROW(check_range("x", -0.5, 0.0, 1.0), Error);
}

TEST(Error, NoCheckLetsNonFiniteNumbersPass) {
  for (const double bad : {kNotANumber, kInf, -kInf}) {
    EXPECT_THROW(check_range("x", bad, -1.0, 1.0), Error) << bad;
    EXPECT_THROW(check_positive("x", bad), Error) << bad;
    EXPECT_THROW(check_not_negative("x", bad), Error) << bad;
    EXPECT_THROW(check_finite("x", bad), Error) << bad;
    EXPECT_THROW(check_finite("x", Vec3(0.0, bad, 0.0)), Error) << bad;
  }
  EXPECT_NO_THROW(check_finite("x", Vec3(0.0, -1e300, 1e-300)));
}

TEST(Error, PositiveExcludesZeroAndNotNegativeIncludesIt) {
  EXPECT_THROW(check_positive("x", 0.0), Error);
  EXPECT_NO_THROW(check_positive("x", 1e-300));
  EXPECT_NO_THROW(check_not_negative("x", 0.0));
  EXPECT_THROW(check_not_negative("x", -1e-300), Error);
}

TEST(Error, IndexLiesBelowCount) {
  EXPECT_NO_THROW(check_index("vertex", 3, 4));
  EXPECT_THROW(check_index("vertex", 4, 4), Error);
  EXPECT_THROW(check_index("vertex", -1, 4), Error);
  EXPECT_THROW(check_index("vertex", 0, 0), Error);
}

TEST(ToText, ReadsBackAsTheSameDouble) {
  for (const double x : {0.1, 1.0 / 3.0, 1e-310, 1.7976931348623157e308, -2.5, 12345.678901234567}) {
    EXPECT_EQ(std::strtod(to_text(x).c_str(), nullptr), x);
  }
  EXPECT_EQ(to_text(kNotANumber), "nan");
  EXPECT_EQ(to_text(-kInf), "-inf");
}

}  // namespace
}  // namespace softpoint

#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "softpoint/core/error.h"
#include "softpoint/core/vec.h"

// Every number of a settings struct tried with every kind of bad and extreme value. The table of a struct is
// made from a structured binding, so that a new field does not compile until it has a row.
namespace softpoint {

inline constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();
inline constexpr double kLargest = std::numeric_limits<double>::max();

// A number in a struct under test, and what is permitted there: `low` to `high`, and the values `also`.
class Field {
 public:
  template <class Number>
  Field(std::string name, Number& number, double low, double high, std::vector<double> also = {})
      : name_(std::move(name)), number_(&number), low_(low), high_(high), also_(std::move(also)) {}

  const std::string& name() const { return name_; }

  bool permits(double value) const {
    for (const double other : also_) {
      if (value == other) return true;
    }
    return value >= low_ && value <= high_;
  }

  void set(double value) const {
    std::visit([&](auto* number) { *number = static_cast<std::remove_pointer_t<decltype(number)>>(value); },
               number_);
  }

  double get() const {
    return std::visit([](auto* number) { return static_cast<double>(*number); }, number_);
  }

  // NaN, infinities, zero, negative, huge, tiny, the ends of the range and their neighbours outside.
  std::vector<double> trials() const {
    std::vector<double> values = also_;
    if (std::holds_alternative<int*>(number_)) {
      for (const double value : {-2147483648.0, -1.0, 0.0, 2147483647.0}) values.push_back(value);
      for (const double end : {low_, high_}) {
        for (const double value : {end - 1, end, end + 1}) {
          if (std::abs(value) < 2147483648.0) values.push_back(value);
        }
      }
      return values;
    }
    const double tiny = std::numeric_limits<double>::denorm_min();
    for (const double value : {kNotANumber, kUnbounded, -kUnbounded, -1.0, 0.0}) values.push_back(value);
    if (std::holds_alternative<float*>(number_)) {
      for (const double value : {-3e38, 3e38}) values.push_back(value);
      return values;
    }
    for (const double value : {-kLargest, kLargest, -1e300, 1e300, -1e30, 1e30, -tiny, tiny, low_, high_}) {
      values.push_back(value);
    }
    for (const double value : {std::nextafter(low_, -kUnbounded), std::nextafter(high_, kUnbounded)}) {
      values.push_back(value);
    }
    return values;
  }

  // What a message says of the range.
  std::vector<std::string> range_texts() const {
    if (low_ > high_ || high_ == kLargest) return {};
    if (low_ == -high_) return {to_text(high_)};  // "up to 5", "-5 to 5"
    return {to_text(low_), to_text(high_)};
  }

 private:
  std::string name_;
  std::variant<double*, float*, int*> number_;
  double low_, high_;
  std::vector<double> also_;
};

using Fields = std::vector<Field>;

// A value within its range may still be refused for what it does together with other fields (a vertex that
// flattens its triangle).
enum class Range { sufficient, necessary };

// The three components, under one name.
inline void add_fields(Fields& fields, const std::string& name, Vec3& value, double low, double high) {
  for (int k = 0; k < 3; ++k) fields.emplace_back(name, value[k], low, high);
}

// A struct's own rows under the names of the struct around it: no prefix, the last words of a message do.
inline void add_fields(Fields& fields, Fields more) { fields.insert(fields.end(), more.begin(), more.end()); }

// Sets each field of a copy of `valid` to each trial value and calls `use` with it. Where the value is not
// permitted `use` has to throw an Error that names field, value and range, and `state()`, a text of all that
// was there before, has to stay the same; where it is permitted `use` has to return true: it worked, and all
// that came out is finite.
template <class Settings>
void expect_every_field(
    const Settings& valid, const std::function<Fields(Settings&)>& fields_of,
    const std::function<bool(const Settings&)>& use,
    const std::function<std::string()>& state = [] { return std::string(); },
    Range range = Range::sufficient) {
  ASSERT_TRUE(use(valid));
  Settings original = valid;
  const std::size_t count = fields_of(original).size();
  for (std::size_t i = 0; i < count; ++i) {
    for (const double value : fields_of(original)[i].trials()) {
      Settings settings = valid;
      const Field field = fields_of(settings)[i];
      field.set(value);
      SCOPED_TRACE(field.name() + " = " + to_text(value));
      const std::string before = state();
      std::string message;
      bool worked = false;
      try {
        worked = use(settings);
      } catch (const Error& error) {
        message = error.what();
      }
      if (field.permits(value)) {
        if (range == Range::sufficient) {
          EXPECT_EQ(message, "") << "a permitted value was refused";
        }
        EXPECT_TRUE(worked || !message.empty()) << "a permitted value did not work";
        continue;
      }
      EXPECT_NE(message, "") << "a value that is not permitted was taken";
      if (message.empty()) continue;
      std::vector<std::string> fragments = field.range_texts();
      fragments.insert(fragments.end(), {field.name(), to_text(field.get()), "permitted"});
      for (const std::string& fragment : fragments) {
        EXPECT_NE(message.find(fragment), std::string::npos)
            << "message: " << message << "\nlacks: " << fragment;
      }
      EXPECT_EQ(state(), before) << "the refusal changed something";
    }
  }
}

inline bool all_finite(std::span<const Vec3> values) {
  for (const Vec3& value : values) {
    if (!value.allFinite()) return false;
  }
  return true;
}

}  // namespace softpoint

#include "softpoint/core/error.h"

#include <charconv>
#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

[[noreturn]] void refuse(std::string_view field, const std::string& value, const std::string& permitted) {
  throw Error(std::string(field) + " = " + value + ": permitted is " + permitted);
}

}  // namespace

std::string to_text(double value) {
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

std::string to_text(const Vec3& value) {
  std::string text = "[";
  text += to_text(value.x()) + ", " + to_text(value.y()) + ", " + to_text(value.z());
  return text + "]";
}

void check_range(std::string_view field, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    refuse(field, to_text(value), to_text(low) + " to " + to_text(high));
  }
}

void check_range(std::string_view field, const Vec3& value, double low, double high) {
  if (!((value.array() >= low).all() && (value.array() <= high).all())) {
    refuse(field, to_text(value), "three numbers, each " + to_text(low) + " to " + to_text(high));
  }
}

void check_positive(std::string_view field, double value) {
  if (!(value > 0.0 && std::isfinite(value))) {
    refuse(field, to_text(value), "a finite number > 0");
  }
}

void check_not_negative(std::string_view field, double value) {
  if (!(value >= 0.0 && std::isfinite(value))) {
    refuse(field, to_text(value), "a finite number >= 0");
  }
}

void check_finite(std::string_view field, double value) {
  if (!std::isfinite(value)) {
    refuse(field, to_text(value), "a finite number");
  }
}

void check_finite(std::string_view field, const Vec3& value) {
  if (!value.allFinite()) {
    refuse(field, to_text(value), "three finite numbers");
  }
}

void check_index(std::string_view field, long long index, long long count) {
  if (index < 0 || index >= count) {
    refuse(field, std::to_string(index),
           count > 0 ? "0 to " + std::to_string(count - 1) : std::string("none (there are no elements)"));
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI

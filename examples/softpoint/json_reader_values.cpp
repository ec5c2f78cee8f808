#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "json_document.h"
#include "json_reader.h"
#include "json_reader_state.h"
#include "nearest.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using nlohmann::json;

const std::string kRequired = "required";

std::string with_unit(Quantity quantity, double value) {
  const std::string_view unit = si_unit(quantity);
  return unit.empty() ? to_text(value) : fmt::format("{} {}", to_text(value), unit);
}

std::string number_type(Quantity quantity) {
  return quantity == Quantity::kNumber ? "number"
                                       : fmt::format("{} in {}", quantity_name(quantity), si_unit(quantity));
}

std::string vec3_type(Quantity quantity) {
  return quantity == Quantity::kNumber
             ? "list of 3 numbers"
             : fmt::format("list of 3: {} in {}", quantity_name(quantity), si_unit(quantity));
}

std::string vec3_text(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", to_text(v.x()), to_text(v.y()), to_text(v.z()));
}

// A permitted value to go on with while describing.
double any_permitted(double low, double high) { return std::clamp(1.0, low, high); }

SchemaEntry number_entry(const NumberSpec& spec, const std::string& absent) {
  return {"",
          "",
          number_type(spec.quantity),
          range_text(spec.quantity, spec.low, spec.high, spec.above),
          absent,
          spec.doc,
          NumberLimits{spec.low, spec.high, spec.above, false}};
}

std::string integer_range(const IntegerSpec& spec) {
  const bool limited =
      spec.low > std::numeric_limits<int>::min() || spec.high < std::numeric_limits<int>::max();
  return limited ? fmt::format("{} to {}", spec.low, spec.high) : "";
}

SchemaEntry integer_entry(const IntegerSpec& spec, const std::string& absent) {
  return {"",
          "",
          "integer",
          integer_range(spec),
          absent,
          spec.doc,
          NumberLimits{static_cast<double>(spec.low), static_cast<double>(spec.high), false, true}};
}

NumberSpec component(const Vec3Spec& spec) { return {spec.quantity, spec.low, spec.high, false, {}, ""}; }

SchemaEntry vec3_entry(const Vec3Spec& spec, const std::string& absent) {
  return {"",
          "",
          vec3_type(spec.quantity),
          range_text(spec.quantity, spec.low, spec.high, false),
          absent,
          spec.doc,
          NumberLimits{spec.low, spec.high, false, false}};
}

}  // namespace

std::string range_text(Quantity quantity, double low, double high, bool above) {
  const bool has_low = std::isfinite(low), has_high = std::isfinite(high);
  if (has_low && has_high) {
    return above ? fmt::format("above {}, up to {}", to_text(low), with_unit(quantity, high))
                 : fmt::format("{} to {}", to_text(low), with_unit(quantity, high));
  }
  if (has_low) {
    return above ? "above " + with_unit(quantity, low) : with_unit(quantity, low) + " or more";
  }
  return has_high ? with_unit(quantity, high) + " or less" : "";
}

double ObjectReader::number_at(const json& value, const std::string& at, const NumberSpec& spec) const {
  const auto refuse_value = [&](const std::string& problem) {
    throw Error(fmt::format("{}: {} = {}: {}", state_->document, at, value_text(value), problem));
  };
  double number = 0.0;
  if (value.is_number()) {
    number = value.get<double>();
  } else if (value.is_string()) {
    const ParsedQuantity parsed = parse_quantity(spec.quantity, value.get_ref<const std::string&>());
    if (!parsed.problem.empty()) {
      refuse_value(parsed.problem);
    }
    number = parsed.value;
  } else {
    refuse_value(
        fmt::format("permitted is a {}{}", number_type(spec.quantity),
                    spec.quantity == Quantity::kNumber ? "" : ", as a number or a text with a unit"));
  }
  const bool inside = number >= spec.low && number <= spec.high && !(spec.above && number == spec.low);
  if (!inside || !std::isfinite(number)) {
    refuse_value("permitted is " + range_text(spec.quantity, spec.low, spec.high, spec.above));
  }
  return number;
}

std::string ObjectReader::text_at(const json& value, const std::string& at) const {
  if (!value.is_string()) {
    throw Error(
        fmt::format("{}: {} = {}: permitted is a text \"...\"", state_->document, at, value_text(value)));
  }
  return value.get<std::string>();
}

double ObjectReader::number(std::string_view key, const NumberSpec& spec) {
  const std::string absent = spec.fallback ? with_unit(spec.quantity, *spec.fallback) : kRequired;
  const json* value = find(key, number_entry(spec, absent), !spec.fallback);
  if (value == nullptr) {
    return spec.fallback.value_or(any_permitted(spec.low, spec.high));
  }
  return number_at(*value, fmt::format("{}/{}", path(), pointer_token(key)), spec);
}

std::optional<double> ObjectReader::optional_number(std::string_view key, const NumberSpec& spec) {
  const json* value = find(key, number_entry(spec, "optional"), false);
  if (value == nullptr || value->is_null()) {
    return std::nullopt;
  }
  return number_at(*value, fmt::format("{}/{}", path(), pointer_token(key)), spec);
}

int ObjectReader::integer(std::string_view key, const IntegerSpec& spec) {
  const json* value = find(
      key, integer_entry(spec, spec.fallback ? std::to_string(*spec.fallback) : kRequired), !spec.fallback);
  if (value == nullptr) {
    return spec.fallback.value_or(static_cast<int>(std::clamp(1LL, spec.low, spec.high)));
  }
  return integer_at(*value, key, spec);
}

std::optional<int> ObjectReader::optional_integer(std::string_view key, const IntegerSpec& spec) {
  const json* value = find(key, integer_entry(spec, "optional"), false);
  if (value == nullptr || value->is_null()) {
    return std::nullopt;
  }
  return integer_at(*value, key, spec);
}

int ObjectReader::integer_at(const json& value, std::string_view key, const IntegerSpec& spec) const {
  if (!value.is_number_integer()) {
    const std::string range = integer_range(spec);
    refuse(key, "permitted is an integer" + (range.empty() ? "" : ", " + range));
  }
  const bool too_large = value.is_number_unsigned() && value.get<unsigned long long>() > INT64_MAX;
  const long long number = too_large ? INT64_MAX : value.get<long long>();
  if (number < spec.low || number > spec.high) {
    refuse(key, fmt::format("permitted is an integer, {} to {}", spec.low, spec.high));
  }
  return static_cast<int>(number);
}

bool ObjectReader::boolean(std::string_view key, const BooleanSpec& spec) {
  const std::string absent = spec.fallback ? (*spec.fallback ? "true" : "false") : kRequired;
  const json* value = find(key, {"", "", "true or false", "", absent, spec.doc}, !spec.fallback);
  if (value == nullptr) {
    return spec.fallback.value_or(false);
  }
  if (!value->is_boolean()) {
    refuse(key, "permitted is true or false");
  }
  return value->get<bool>();
}

std::optional<bool> ObjectReader::optional_boolean(std::string_view key, const BooleanSpec& spec) {
  const json* value = find(key, {"", "", "true or false", "", "optional", spec.doc}, false);
  if (value == nullptr || value->is_null()) {
    return std::nullopt;
  }
  if (!value->is_boolean()) {
    refuse(key, "permitted is true or false");
  }
  return value->get<bool>();
}

std::string ObjectReader::text(std::string_view key, const TextSpec& spec) {
  const std::string absent = spec.fallback ? "\"" + *spec.fallback + "\"" : kRequired;
  const json* value = find(key, {"", "", "text", "", absent, spec.doc}, !spec.fallback);
  return value != nullptr ? text_at(*value, fmt::format("{}/{}", path(), pointer_token(key)))
                          : spec.fallback.value_or("");
}

std::filesystem::path ObjectReader::file(std::string_view key, const TextSpec& spec) {
  const std::string absent = spec.fallback ? "\"" + *spec.fallback + "\"" : kRequired;
  const json* value =
      find(key, {"", "", "file name", "relative to the document", absent, spec.doc}, !spec.fallback);
  if (value == nullptr) {
    return spec.fallback ? state_->folder / *spec.fallback : std::filesystem::path();
  }
  const std::string name = text_at(*value, fmt::format("{}/{}", path(), pointer_token(key)));
  if (name.empty() || name.find('\0') != std::string::npos) {
    refuse(key, "permitted is the name of a file");
  }
  return state_->folder / name;
}

Vec3 ObjectReader::vec3(std::string_view key, const Vec3Spec& spec) {
  const std::string absent = spec.fallback ? vec3_text(*spec.fallback) : kRequired;
  const json* value = find(key, vec3_entry(spec, absent), !spec.fallback);
  if (value == nullptr) {
    return spec.fallback.value_or(Vec3::Constant(any_permitted(spec.low, spec.high)));
  }
  return vec3_at(*value, key, spec);
}

std::optional<Vec3> ObjectReader::optional_vec3(std::string_view key, const Vec3Spec& spec) {
  const json* value = find(key, vec3_entry(spec, "optional"), false);
  if (value == nullptr || value->is_null()) {
    return std::nullopt;
  }
  return vec3_at(*value, key, spec);
}

Vec3 ObjectReader::vec3_at(const json& value, std::string_view key, const Vec3Spec& spec) const {
  if (!value.is_array() || value.size() != 3) {
    refuse(key, "permitted is a " + vec3_type(spec.quantity));
  }
  Vec3 result;
  for (int k = 0; k < 3; ++k) {
    result[k] = number_at(value[static_cast<std::size_t>(k)],
                          fmt::format("{}/{}/{}", path(), pointer_token(key), k), component(spec));
  }
  return result;
}

std::array<std::optional<double>, 3> ObjectReader::partial_vec3(std::string_view key, const Vec3Spec& spec) {
  SchemaEntry entry = vec3_entry(spec, kRequired);
  entry.type += ", each or null";
  const json* value = find(key, entry, true);
  std::array<std::optional<double>, 3> result;
  if (value == nullptr) {
    return result;
  }
  if (!value->is_array() || value->size() != 3) {
    refuse(key, "permitted is a " + entry.type);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(*value)[k].is_null()) {
      result[k] =
          number_at((*value)[k], fmt::format("{}/{}/{}", path(), pointer_token(key), k), component(spec));
    }
  }
  return result;
}

std::vector<int> ObjectReader::indices(std::string_view key, const IndexListSpec& spec) {
  ListSpec list{.min = spec.min, .doc = spec.doc};
  if (!describing()) {
    list.max = spec.count;
  }
  const json* value = find_list(key, "integers, " + spec.of + " counted from 0", list,
                                NumberLimits{0.0, std::numeric_limits<int>::max(), false, true});
  std::vector<int> result;
  if (value == nullptr) {
    return result;
  }
  std::unordered_set<int> seen;
  for (std::size_t k = 0; k < value->size(); ++k) {
    const json& item = (*value)[k];
    const auto refuse_item = [&](const std::string& problem) {
      throw Error(fmt::format("{}: {}/{}/{} = {}: {}", document(), path(), pointer_token(key), k,
                              value_text(item), problem));
    };
    // Unsigned first: what does not fit a long long is out of range all the same.
    if (!item.is_number_integer() || !item.is_number_unsigned() ||
        item.get<unsigned long long>() >= static_cast<unsigned long long>(std::max(spec.count, 0))) {
      refuse_item(fmt::format("permitted is an integer, 0 to {}: there are {} {}", spec.count - 1, spec.count,
                              spec.of));
    }
    result.push_back(item.get<int>());
    if (!seen.insert(result.back()).second) {
      refuse_item("it stands in the list twice; remove one");
    }
  }
  return result;
}

std::vector<double> ObjectReader::numbers(std::string_view key, const NumberSpec& item,
                                          const ListSpec& spec) {
  const std::string range = range_text(item.quantity, item.low, item.high, item.above);
  const json* value = find_list(key, number_type(item.quantity) + (range.empty() ? "" : " (" + range + ")"),
                                spec, NumberLimits{item.low, item.high, item.above, false});
  std::vector<double> result;
  if (value != nullptr) {
    for (std::size_t k = 0; k < value->size(); ++k) {
      result.push_back(number_at((*value)[k], fmt::format("{}/{}/{}", path(), pointer_token(key), k), item));
    }
  }
  return result;
}

int ObjectReader::choice(std::string_view key, const std::vector<std::string>& names, const TextSpec& spec) {
  const std::string permitted = "one of " + joined(names);
  const std::string absent = spec.fallback ? "\"" + *spec.fallback + "\"" : kRequired;
  const json* value = find(key, {"", "", "text", permitted, absent, spec.doc}, !spec.fallback);
  if (value == nullptr && !spec.fallback) {
    return 0;
  }
  const std::string name =
      value != nullptr ? text_at(*value, fmt::format("{}/{}", path(), pointer_token(key))) : *spec.fallback;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    const std::string meant = nearest(name, names);
    refuse(key, "permitted is " + permitted + (meant.empty() ? "" : "; did you mean \"" + meant + "\"?"));
  }
  return static_cast<int>(found - names.begin());
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "json_reader.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

struct ObjectReader::State {
  const std::string& document;
  const std::filesystem::path& folder;
  const nlohmann::json* object;  // null while describing
  Schema* schema;                // null while reading
  std::string path;
  std::string when;                  // the variant being described, for the schema
  std::vector<std::string> asked{};  // keys
};

// A value for a message: JSON, cut short.
std::string value_text(const nlohmann::json& value);
// "0 m or more", "0 to 1", ...; "" without limits.
std::string range_text(Quantity quantity, double low, double high, bool above);
// "box, sphere"
std::string joined(const std::vector<std::string>& words);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

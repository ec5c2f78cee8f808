#pragma once

#include <optional>
#include <string>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// What is permitted of a number, in SI units; both ends are unless `above` says that `low` is not.
struct NumberLimits {
  double low = 0, high = 0;
  bool above = false;
  bool integer = false;
};

// One key that a document may hold.
struct SchemaEntry {
  std::string path;       // "/bodies/*/mass"
  std::string when;       // "shape = box": only then is the key known; else ""
  std::string type;       // "length", "3 lengths", "text", "object", "list of objects", ...
  std::string permitted;  // "0 m or more", "one of box, sphere", "" if anything of the type
  std::string fallback;   // what stands for an absent key; "required", "optional", or the default
  std::string doc;
  std::optional<NumberLimits> limits = std::nullopt;  // of numbers, one by one or in a list
};

// What the readers of a kind of document ask for, in the order they ask.
struct Schema {
  std::vector<SchemaEntry> entries;
};

// For the terminal: one key a paragraph, indented by depth.
std::string schema_text(const Schema& schema);
// A table in Markdown.
std::string schema_markdown(const Schema& schema);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

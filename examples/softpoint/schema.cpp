#include "schema.h"

#include <fmt/format.h>

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

std::string facts(const SchemaEntry& entry) {
  std::string result = entry.type;
  if (!entry.permitted.empty()) {
    result += ", " + entry.permitted;
  }
  const bool is_word = entry.fallback == "required" || entry.fallback == "optional";
  result += (is_word ? "; " : "; default ") + entry.fallback;
  return result;
}

std::string escaped(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) {
    text.insert(at, 1, '\\');
  }
  return text;
}

}  // namespace

std::string schema_text(const Schema& schema) {
  std::string text;
  for (const SchemaEntry& entry : schema.entries) {
    const auto depth = static_cast<std::size_t>(std::count(entry.path.begin(), entry.path.end(), '/'));
    const std::string indent(depth > 0 ? 2 * (depth - 1) : 0, ' ');
    text += fmt::format("{}{}{}\n", indent, entry.path,
                        entry.when.empty() ? "" : fmt::format("   (if {})", entry.when));
    text += fmt::format("{}    {}\n", indent, facts(entry));
    if (!entry.doc.empty()) {
      text += fmt::format("{}    {}\n", indent, entry.doc);
    }
  }
  return text;
}

std::string schema_markdown(const Schema& schema) {
  std::string text = "| key | type | permitted | default | meaning |\n|---|---|---|---|---|\n";
  for (const SchemaEntry& entry : schema.entries) {
    text += fmt::format("| `{}`{} | {} | {} | {} | {} |\n", entry.path,
                        entry.when.empty() ? "" : fmt::format(" (if {})", escaped(entry.when)),
                        escaped(entry.type), escaped(entry.permitted), escaped(entry.fallback),
                        escaped(entry.doc));
  }
  return text;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#include "json_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "json_document.h"
#include "json_reader_state.h"
#include "nearest.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxValueText = 60;

}  // namespace

std::string value_text(const json& value) {
  if (value.is_object() || value.is_array()) {
    const bool is_object = value.is_object();
    if (value.size() > 4) {
      return fmt::format("{} of {}", is_object ? "an object" : "a list", value.size());
    }
  }
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > kMaxValueText) {
    text.resize(kMaxValueText);
    text += "...";
  }
  return text;
}

std::string joined(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) {
    list += (list.empty() ? "" : ", ");
    list += word;
  }
  return list;
}

ObjectReader::ObjectReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
ObjectReader::~ObjectReader() = default;

bool ObjectReader::describing() const { return state_->object == nullptr; }
const std::string& ObjectReader::path() const { return state_->path; }
const std::string& ObjectReader::document() const { return state_->document; }

bool ObjectReader::has(std::string_view key) const {
  return !describing() && state_->object->contains(std::string(key));
}

void ObjectReader::refuse(const std::string& problem) const {
  throw Error(
      fmt::format("{}: {}: {}", state_->document, state_->path.empty() ? "/" : state_->path, problem));
}

void ObjectReader::refuse(std::string_view key, const std::string& problem) const {
  const bool there = has(key);
  throw Error(fmt::format("{}: {}/{}{}: {}", state_->document, state_->path, pointer_token(key),
                          there ? " = " + value_text(state_->object->at(std::string(key))) : "", problem));
}

// Ask for a key: record it, and find its value; null if absent, or while describing.
const json* ObjectReader::find(std::string_view key, const SchemaEntry& entry, bool required) {
  state_->asked.emplace_back(key);
  if (describing()) {
    SchemaEntry described = entry;
    described.path = fmt::format("{}/{}", state_->path, pointer_token(key));
    described.when = state_->when;
    state_->schema->entries.push_back(std::move(described));
    return nullptr;
  }
  const auto found = state_->object->find(std::string(key));
  if (found != state_->object->end()) {
    return &*found;
  }
  if (required) {
    std::vector<std::string> present;
    for (const auto& [name, value] : state_->object->items()) {
      if (std::find(state_->asked.begin(), state_->asked.end(), name) == state_->asked.end()) {
        present.push_back(name);
      }
    }
    const std::string meant = nearest(key, present);
    const std::string hint =
        meant.empty() ? "" : fmt::format("; there is \"{}\", did you mean \"{}\"?", meant, key);
    refuse(fmt::format("\"{}\" is missing: required is {} {}{}{}", key, entry.type,
                       entry.doc.empty() ? "" : "(" + entry.doc + ")", entry.permitted, hint));
  }
  return nullptr;
}

void ObjectReader::finish() const {
  if (describing()) {
    return;
  }
  for (const auto& [name, value] : state_->object->items()) {
    if (std::find(state_->asked.begin(), state_->asked.end(), name) != state_->asked.end()) {
      continue;
    }
    std::vector<std::string> permitted = state_->asked;
    std::sort(permitted.begin(), permitted.end());
    const std::string meant = nearest(name, permitted);
    throw Error(
        fmt::format("{}: {}/{} = {}: unknown key{}; {}", state_->document, state_->path, pointer_token(name),
                    value_text(value), meant.empty() ? "" : fmt::format(", did you mean \"{}\"?", meant),
                    permitted.empty() ? "none is permitted here" : "permitted are " + joined(permitted)));
  }
}

void ObjectReader::read_child(const json* value, const std::string& child_path, const ReadObject& read) {
  if (value != nullptr && !value->is_object()) {
    throw Error(fmt::format("{}: {} = {}: permitted is an object {{...}}", state_->document, child_path,
                            value_text(*value)));
  }
  ObjectReader child(std::make_unique<State>(
      State{state_->document, state_->folder, value, state_->schema, child_path, state_->when}));
  read(child);
  child.finish();
}

bool ObjectReader::nested(std::string_view key, const std::string& doc, bool required,
                          const ReadObject& read) {
  const json* value = find(key, {"", "", "object", "", required ? "required" : "optional", doc}, required);
  if (value != nullptr || describing()) {
    read_child(value, fmt::format("{}/{}", state_->path, pointer_token(key)), read);
    return true;
  }
  return false;
}

bool ObjectReader::object(std::string_view key, const std::string& doc, const ReadObject& read) {
  return nested(key, doc, true, read);
}

bool ObjectReader::optional_object(std::string_view key, const std::string& doc, const ReadObject& read) {
  return nested(key, doc, false, read);
}

const json* ObjectReader::find_list(std::string_view key, const std::string& item_type, const ListSpec& spec,
                                    std::optional<NumberLimits> limits) {
  std::string length;
  if (spec.max < std::numeric_limits<int>::max()) {
    length = spec.min == spec.max ? fmt::format("{} of them", spec.min)
                                  : fmt::format("{} to {} of them", spec.min, spec.max);
  } else if (spec.min > 0) {
    length = fmt::format("{} or more of them", spec.min);
  }
  const SchemaEntry entry{
      "", "", "list of " + item_type, length, spec.optional ? "optional" : "required", spec.doc, limits};
  const json* value = find(key, entry, !spec.optional);
  if (value == nullptr) {
    return nullptr;
  }
  if (!value->is_array()) {
    refuse(key, "permitted is a list [...] of " + item_type);
  }
  const auto size = static_cast<long long>(value->size());
  if (size < spec.min || size > spec.max) {
    refuse(key, fmt::format("{} of them: permitted are {}", size, length));
  }
  return value;
}

int ObjectReader::list(std::string_view key, const ListSpec& spec, const ReadItem& read) {
  const json* value = find_list(key, "objects", spec);
  const std::string list_path = fmt::format("{}/{}", state_->path, pointer_token(key));
  if (describing()) {
    read_child(nullptr, list_path + "/*", [&](ObjectReader& item) { read(item, 0); });
    return 0;
  }
  if (value == nullptr) {
    return 0;
  }
  const int size = static_cast<int>(value->size());
  for (int index = 0; index < size; ++index) {
    read_child(&(*value)[static_cast<std::size_t>(index)], fmt::format("{}/{}", list_path, index),
               [&](ObjectReader& item) { read(item, index); });
  }
  return size;
}

void ObjectReader::variant(std::string_view key, const std::vector<Variant>& variants, const TextSpec& spec) {
  std::vector<std::string> names;
  std::string doc = spec.doc;
  for (const Variant& variant : variants) {
    names.push_back(variant.name);
    if (!variant.doc.empty()) {
      doc += fmt::format("{}{}: {}", doc.empty() ? "" : "; ", variant.name, variant.doc);
    }
  }
  const int chosen = choice(key, names, {spec.fallback, doc});
  if (!describing()) {
    variants[static_cast<std::size_t>(chosen)].read(*this);
    return;
  }
  const std::string outer = state_->when;
  for (const Variant& variant : variants) {
    state_->when = fmt::format("{}{}{} = {}", outer, outer.empty() ? "" : ", ", key, variant.name);
    variant.read(*this);
  }
  state_->when = outer;
}

void read_json_text(std::string_view text, const std::string& file, const std::filesystem::path& folder,
                    const ReadObject& read) {
  const json root = parse_json(text, file);
  if (!root.is_object()) {
    throw Error(fmt::format("{}: / = {}: permitted is an object {{...}}", file, value_text(root)));
  }
  ObjectReader reader(
      std::make_unique<ObjectReader::State>(ObjectReader::State{file, folder, &root, nullptr, "", ""}));
  read(reader);
  reader.finish();
}

void read_json_file(const std::filesystem::path& path, const ReadObject& read) {
  read_json_text(read_text_file(path), path.string(), path.parent_path(), read);
}

Schema describe(const ReadObject& read) {
  const std::string file = "schema";
  const std::filesystem::path folder;
  Schema schema;
  ObjectReader reader(
      std::make_unique<ObjectReader::State>(ObjectReader::State{file, folder, nullptr, &schema, "", ""}));
  read(reader);
  return schema;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

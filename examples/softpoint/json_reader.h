#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema.h"
#include "softpoint/core/vec.h"
#include "units.h"

// A strict reader of JSON documents. Whoever reads an object asks for its keys one by one, saying type,
// unit, permitted range, default and meaning; a key that nobody asked for is refused when the object
// ends. Each refusal is an Error with the file, the path in the document, the value, and what is
// permitted. The same code, run without a document, lists what it would ask for: that is the schema.
namespace softpoint::inline SOFTPOINT_ABI::scene {

class ObjectReader;
using ReadObject = std::function<void(ObjectReader&)>;
using ReadItem = std::function<void(ObjectReader&, int index)>;

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// `low` and `high` in SI units, both permitted unless `above` says that `low` is not; documents of this
// program set both, so that no number in them overflows. A key without `fallback` is required.
struct NumberSpec {
  Quantity quantity = Quantity::kNumber;
  double low = -kNoLimit;
  double high = kNoLimit;
  bool above = false;
  std::optional<double> fallback = std::nullopt;
  std::string doc = "";
};

struct IntegerSpec {
  long long low = std::numeric_limits<int>::min();
  long long high = std::numeric_limits<int>::max();
  std::optional<int> fallback = std::nullopt;
  std::string doc = "";
};

// Three numbers; the limits hold for each.
struct Vec3Spec {
  Quantity quantity = Quantity::kNumber;
  double low = -kNoLimit;
  double high = kNoLimit;
  std::optional<Vec3> fallback = std::nullopt;
  std::string doc = "";
};

struct TextSpec {
  std::optional<std::string> fallback = std::nullopt;
  std::string doc = "";
};

struct BooleanSpec {
  std::optional<bool> fallback = std::nullopt;
  std::string doc = "";
};

// A list; without `optional` the key is required.
struct ListSpec {
  int min = 0;
  int max = std::numeric_limits<int>::max();
  bool optional = false;
  std::string doc = "";
};

// Indices 0 to count - 1 of elements called `of` ("vertices of the mesh"), each at most once.
struct IndexListSpec {
  int count = 0;
  std::string of = "elements";
  int min = 1;
  std::string doc = "";
};

// One way to go on reading an object, chosen by the text at a key.
struct Variant {
  std::string name;
  std::string doc;
  ReadObject read;
};

class ObjectReader {
 public:
  ~ObjectReader();
  ObjectReader(const ObjectReader&) = delete;
  ObjectReader& operator=(const ObjectReader&) = delete;

  double number(std::string_view key, const NumberSpec& spec);
  // Absent, or null: empty. `spec.fallback` is not used.
  std::optional<double> optional_number(std::string_view key, const NumberSpec& spec);
  int integer(std::string_view key, const IntegerSpec& spec);
  // Absent, or null: empty. `spec.fallback` is not used.
  std::optional<int> optional_integer(std::string_view key, const IntegerSpec& spec);
  bool boolean(std::string_view key, const BooleanSpec& spec);
  std::optional<bool> optional_boolean(std::string_view key, const BooleanSpec& spec);
  std::string text(std::string_view key, const TextSpec& spec);
  Vec3 vec3(std::string_view key, const Vec3Spec& spec);
  // Absent, or null: empty. `spec.fallback` is not used.
  std::optional<Vec3> optional_vec3(std::string_view key, const Vec3Spec& spec);
  // Three numbers, any of which may be null.
  std::array<std::optional<double>, 3> partial_vec3(std::string_view key, const Vec3Spec& spec);
  std::vector<int> indices(std::string_view key, const IndexListSpec& spec);
  std::vector<double> numbers(std::string_view key, const NumberSpec& item, const ListSpec& spec);
  // A file named relative to the document's folder; not opened here.
  std::filesystem::path file(std::string_view key, const TextSpec& spec);

  // One of the names given; returns its position.
  int choice(std::string_view key, const std::vector<std::string>& names, const TextSpec& spec);
  template <class Value>
  Value choice(std::string_view key, const std::vector<std::pair<std::string, Value>>& values,
               const TextSpec& spec) {
    std::vector<std::string> names;
    for (const auto& [name, value] : values) {
      names.push_back(name);
    }
    return values[static_cast<std::size_t>(choice(key, names, spec))].second;
  }

  // Nested objects. Returns whether the key is there (true while describing).
  bool object(std::string_view key, const std::string& doc, const ReadObject& read);
  bool optional_object(std::string_view key, const std::string& doc, const ReadObject& read);
  // A list of objects; returns how many there are.
  int list(std::string_view key, const ListSpec& spec, const ReadItem& read);
  // Reads on in this very object by the variant named at `key`.
  void variant(std::string_view key, const std::vector<Variant>& variants, const TextSpec& spec);

  // Whether the document holds the key; asks for nothing and documents nothing. False while describing.
  bool has(std::string_view key) const;
  // No document here: getters give defaults or arbitrary permitted values, files do not exist.
  bool describing() const;
  // "/bodies/2", "" for the root.
  const std::string& path() const;
  // "scene.json"
  const std::string& document() const;

  // "scene.json: /bodies/2/mass = 3: <problem>"
  [[noreturn]] void refuse(std::string_view key, const std::string& problem) const;
  // "scene.json: /bodies/2: <problem>"
  [[noreturn]] void refuse(const std::string& problem) const;

 private:
  friend void read_json_text(std::string_view, const std::string&, const std::filesystem::path&,
                             const ReadObject&);
  friend Schema describe(const ReadObject&);
  struct State;
  explicit ObjectReader(std::unique_ptr<State> state);

  const nlohmann::json* find(std::string_view key, const SchemaEntry& entry, bool required);
  const nlohmann::json* find_list(std::string_view key, const std::string& item_type, const ListSpec& spec,
                                  std::optional<NumberLimits> limits = std::nullopt);
  double number_at(const nlohmann::json& value, const std::string& path, const NumberSpec& spec) const;
  int integer_at(const nlohmann::json& value, std::string_view key, const IntegerSpec& spec) const;
  Vec3 vec3_at(const nlohmann::json& value, std::string_view key, const Vec3Spec& spec) const;
  std::string text_at(const nlohmann::json& value, const std::string& path) const;
  bool nested(std::string_view key, const std::string& doc, bool required, const ReadObject& read);
  void read_child(const nlohmann::json* value, const std::string& path, const ReadObject& read);
  void finish() const;

  std::unique_ptr<State> state_;
};

// Read the document in a file, or in a text (`file` heads the messages; files named in the document are
// relative to `folder`). The root has to be an object.
void read_json_file(const std::filesystem::path& path, const ReadObject& read);
void read_json_text(std::string_view text, const std::string& file, const std::filesystem::path& folder,
                    const ReadObject& read);

// What `read` asks for.
Schema describe(const ReadObject& read);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

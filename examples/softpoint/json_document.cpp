#include "json_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using nlohmann::json;

// Builds the document from the parser's events. The library's own builder keeps the last of two equal
// keys and knows no depth limit.
class Builder final : public nlohmann::json_sax<json> {
 public:
  Builder(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  json take() { return std::move(root_); }

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    if (open_.back().value->contains(name)) {
      throw Error(fmt::format("{}: {}/{}: the key stands twice in its object; remove one", file_, path(),
                              pointer_token(name)));
    }
    open_.back().key = std::move(name);
    return true;
  }

  bool parse_error(std::size_t position, const std::string& token,
                   const nlohmann::detail::exception& error) override {
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(position, text_.size()));
    const auto line = std::count(text_.begin(), end, '\n') + 1;
    const auto line_start = std::find(std::make_reverse_iterator(end), text_.rend(), '\n').base();
    // JSON knows no NaN and no infinity, and takes no number that is too large for a double.
    const auto word = token.find_last_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ") + 1;
    const bool no_number =
        error.id == 406 ||
        (word < token.size() && std::string_view("NnIi").find(token[word]) != std::string_view::npos);
    throw Error(fmt::format("{}:{}:{}: {}{}{}{}", file_, line, std::max<std::ptrdiff_t>(end - line_start, 1),
                            open_.empty() ? "" : "near " + value_path() + ": ",
                            token.empty() ? "" : fmt::format("at '{}': ", token.substr(0, 60)),
                            explanation(error.what()), no_number ? "; permitted are finite numbers" : ""));
  }

 private:
  struct Level {
    json* value;
    std::string key;  // of the member being read; objects only
  };

  template <class Value>
  bool put(Value&& value) {
    place(json(std::forward<Value>(value)));
    return true;
  }

  json* place(json&& value) {
    if (open_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    Level& level = open_.back();
    if (level.value->is_array()) {
      level.value->push_back(std::move(value));
      return &level.value->back();
    }
    json& member = (*level.value)[level.key];
    member = std::move(value);
    return &member;
  }

  bool open(json&& empty) {
    if (static_cast<int>(open_.size()) >= kMaxDocumentDepth) {
      throw Error(fmt::format("{}: {}: nested deeper than {} levels", file_, path(), kMaxDocumentDepth));
    }
    json* value = place(std::move(empty));
    open_.push_back({value, {}});
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  // Of the innermost open object or array.
  std::string path() const {
    std::string result;
    for (std::size_t k = 0; k + 1 < open_.size(); ++k) {
      const Level& level = open_[k];
      result += '/';
      result += level.value->is_array() ? std::to_string(level.value->size() - 1) : pointer_token(level.key);
    }
    return result;
  }

  // Of the value being read, or the one read last.
  std::string value_path() const {
    const Level& level = open_.back();
    return fmt::format(
        "{}/{}", path(),
        level.value->is_array() ? std::to_string(level.value->size()) : pointer_token(level.key));
  }

  // The library's text without its own head "[json.exception.parse_error.101] parse error at line 1,
  // column 2: ".
  static std::string explanation(std::string_view text) {
    const auto bracket = text.find("] ");
    if (bracket != std::string_view::npos) {
      text.remove_prefix(bracket + 2);
    }
    constexpr std::string_view kHead = "parse error at line ";
    if (text.starts_with(kHead)) {
      text.remove_prefix(std::min(text.size(), text.find(": ") + 2));
    }
    return std::string(text);
  }

  std::string_view text_;
  const std::string& file_;
  json root_;
  std::vector<Level> open_;
};

}  // namespace

json parse_json(std::string_view text, const std::string& file) {
  Builder builder(text, file);
  json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

std::string read_text_file(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw Error(file + ": is a folder; name a JSON file");
  }
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    throw Error(
        fmt::format("{}: cannot be read ({})", file, errno != 0 ? std::strerror(errno) : "open failed"));
  }
  // In pieces: the size of a pipe or a device is not known beforehand.
  std::string text;
  std::vector<char> piece(1 << 16);
  while (in && text.size() <= kMaxDocumentBytes) {
    in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    text.append(piece.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (in.bad()) {
    throw Error(file + ": reading failed half-way");
  }
  if (text.size() > kMaxDocumentBytes) {
    throw Error(
        fmt::format("{}: larger than {} MiB, the most a document may have", file, kMaxDocumentBytes >> 20));
  }
  return text;
}

std::string pointer_token(std::string_view key) {
  std::string result;
  for (const char c : key) {
    if (c == '~') {
      result += "~0";
    } else if (c == '/') {
      result += "~1";
    } else {
      result += c;
    }
  }
  return result;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

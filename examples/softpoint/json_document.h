#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// What a document may be, so that a hostile or mistaken file is refused early.
inline constexpr std::size_t kMaxDocumentBytes = 64u << 20;
inline constexpr int kMaxDocumentDepth = 64;

// Strict JSON (RFC 8259): no comments, no trailing commas, no NaN, no key twice in one object.
// `file` heads the messages. Throws Error with line and column for a syntax error.
nlohmann::json parse_json(std::string_view text, const std::string& file);

// The bytes of a file of at most kMaxDocumentBytes. Throws Error.
std::string read_text_file(const std::filesystem::path& path);

// A key as part of a path in a document: "~" becomes "~0" and "/" becomes "~1" (RFC 6901).
std::string pointer_token(std::string_view key);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

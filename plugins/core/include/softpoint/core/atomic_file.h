#pragma once

#include <filesystem>
#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Throws Error unless `path` is, or could become, a regular file: for complaining before long work
// rather than after it.
SOFTPOINT_API void check_writable(const std::filesystem::path& path);

// Write `content` to a new file beside `path` and rename it over `path`: a reader, or a crash half-way,
// finds the old file or the new one, never a part. A link stays; the file it
// leads to is replaced. Throws Error naming the file and the system's reason.
SOFTPOINT_API void write_atomically(const std::filesystem::path& path, std::string_view content);

}  // namespace softpoint::inline SOFTPOINT_ABI

#pragma once

#include <filesystem>
#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Write `content` to a new file beside `path` and rename it over `path`: a reader, or a crash half-way,
// finds the old file or the new one, never a part. Throws Error naming the file and the system's reason.
void write_atomically(const std::filesystem::path& path, std::string_view content);

}  // namespace softpoint::inline SOFTPOINT_ABI

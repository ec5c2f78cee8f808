#pragma once

#include <string>

#include "softpoint/picture/image.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// 8-bit RGB, the image's opacity dropped. `compression` 1 (fast) to 3 (small). Throws Error naming the file
// when it cannot be written; no half-written file stays behind.
SOFTPOINT_API void write_png(const std::string& path, const Image& image, int compression = 1);

// Any PNG libpng reads, as opaque 8-bit RGB. Throws Error naming the file.
SOFTPOINT_API Image read_png(const std::string& path);

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

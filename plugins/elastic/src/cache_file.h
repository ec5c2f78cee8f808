#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "softpoint/elastic/boundary_stiffness.h"

// One matrix, one file: header, key, payload, checksum over all of it.
namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Everything the matrix depends on, byte by byte. `model` needs its mesh, Poisson's ratio, quadrature
// and instruction set; the matrices may be missing.
std::string cache_key(const BoundaryStiffness& model, bool keep_traction);

// 32 hexadecimal digits.
std::string key_digest(const std::string& key);

std::size_t cache_file_bytes(const BoundaryStiffness& model, const std::string& key, bool keep_traction);

enum class CacheRead { kFound, kMissing, kRejected };

// Fills the matrices of `model`. Never throws for what the file holds.
CacheRead read_cache_file(const std::filesystem::path& path, const std::string& key, bool keep_traction,
                          BoundaryStiffness& model);

// Writes a file beside `path`, forces it to disk and renames it. False, leaving nothing behind, when any
// of it fails.
bool write_cache_file(const std::filesystem::path& path, const std::string& key,
                      const BoundaryStiffness& model);

// The names of unfinished files begin with the final name and this.
inline constexpr const char* kPartSuffix = ".part-";

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

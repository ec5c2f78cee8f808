#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "softpoint/core/config.h"
#include "softpoint/elastic/boundary_stiffness.h"

// Boundary stiffness kept on disk between program runs. Everything that can be wrong with a cache (no
// folder, read-only, full, truncated, foreign or damaged files, several processes at once) costs time
// only: the matrix is then assembled anew.
namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Where stiffness is kept, and how much of it.
struct CacheSettings {
  // Folder of the cache files; empty switches the cache off. The default is the environment variable
  // SOFTPOINT_CACHE_DIR if set (empty: off), else $XDG_CACHE_HOME/softpoint, else
  // $HOME/.cache/softpoint, else off.
  std::string folder = default_folder();
  // Oldest files are deleted when the folder's cache files exceed this; a larger matrix is not kept.
  double capacity = 512.0 * 1024 * 1024;  // bytes

  // What the environment says, as above.
  SOFTPOINT_API static std::string default_folder();
};

// Throws Error naming the field, its value and the permitted range.
SOFTPOINT_API void check(const CacheSettings& cache);

// Since the program started, all threads.
struct CacheCounters {
  std::uint64_t hits = 0;      // read from a file
  std::uint64_t misses = 0;    // no usable file: assembled (those rejected included)
  std::uint64_t rejected = 0;  // a file of the right name with wrong content
  std::uint64_t written = 0;   // files written
  std::uint64_t evicted = 0;   // files deleted to stay under the capacity
};
// As they stand.
SOFTPOINT_API CacheCounters cache_counters();

// From the cache, else by assemble_stiffness, then kept. The key covers the bits of the mesh, Poisson's
// ratio, the resolved quadrature, the instruction set and whether V^-1 W is kept. Throws only what
// assemble_stiffness throws.
SOFTPOINT_API std::shared_ptr<const BoundaryStiffness> load_or_assemble_stiffness(
    const TriangleMesh& mesh, double poisson, const StiffnessSettings& settings = {},
    const CacheSettings& cache = {});

// The file in which load_or_assemble_stiffness keeps this matrix; empty when the cache is off.
SOFTPOINT_API std::string cache_path(const TriangleMesh& mesh, double poisson,
                                     const StiffnessSettings& settings = {}, const CacheSettings& cache = {});

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

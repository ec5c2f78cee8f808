#include "softpoint/elastic/stiffness_cache.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

#include "assemble.h"
#include "cache_file.h"
#include "instruction_set.h"
#include "softpoint/core/error.h"
#include "softpoint/elastic/material.h"
#include "stopwatch.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtension = ".stiffness";

std::atomic<std::uint64_t> hits, misses, rejected, written, evicted;

// What the key is made of; the matrices are still missing.
BoundaryStiffness described(const TriangleMesh& mesh, double poisson, const StiffnessSettings& settings) {
  BoundaryStiffness model;
  model.mesh = mesh;
  model.poisson = poisson;
  model.quadrature = settings.quadrature.resolved(mesh.vertex_count());
  model.instruction_set = choose_instruction_set(settings.max_instruction_set);
  return model;
}

fs::path file_of(const CacheSettings& cache, const std::string& key) {
  return fs::path(cache.folder) / (key_digest(key) + kExtension);
}

struct Entry {
  fs::file_time_type time;
  double bytes;
  fs::path path;
};

// Deletes the least recently used files beyond the capacity, and what crashed writers left behind.
void evict(const fs::path& folder, double capacity, const fs::path& keep) {
  std::error_code error;
  std::vector<Entry> entries;
  double sum = 0.0;
  const auto now = fs::file_time_type::clock::now();
  fs::directory_iterator file(folder, error), end;
  for (; !error && file != end; file.increment(error)) {
    std::error_code ignored;
    const auto time = file->last_write_time(ignored);
    const bool unfinished =
        file->path().filename().string().find(std::string(kExtension) + kPartSuffix) != std::string::npos;
    if (unfinished && now - time > std::chrono::hours(1)) {
      fs::remove(file->path(), ignored);
    } else if (file->path().extension() == kExtension && file->is_regular_file(ignored)) {
      const auto bytes = static_cast<double>(file->file_size(ignored));
      if (ignored) continue;
      sum += bytes;
      if (file->path() != keep) entries.push_back({time, bytes, file->path()});
    }
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.time < b.time; });
  for (const Entry& entry : entries) {
    if (sum <= capacity) break;
    if (fs::remove(entry.path, error)) ++evicted;
    sum -= entry.bytes;
  }
}

bool keep(const fs::path& path, const std::string& key, const BoundaryStiffness& model,
          const CacheSettings& cache) {
  if (static_cast<double>(cache_file_bytes(model, key, !model.unit_traction.empty())) > cache.capacity) {
    return false;
  }
  std::error_code ignored;
  fs::create_directories(cache.folder, ignored);
  if (!write_cache_file(path, key, model)) return false;
  evict(cache.folder, cache.capacity, path);
  return true;
}

std::string environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

}  // namespace

void check(const CacheSettings& cache) {
  check_not_negative("cache.capacity", cache.capacity);
  if (cache.folder.find('\0') != std::string::npos) {
    throw Error("cache.folder holds a zero byte: permitted is the name of a folder, or the empty text");
  }
}

std::string CacheSettings::default_folder() {
  if (std::getenv("SOFTPOINT_CACHE_DIR") != nullptr) return environment("SOFTPOINT_CACHE_DIR");
  // A relative XDG_CACHE_HOME is to be ignored, says its specification.
  const fs::path caches = environment("XDG_CACHE_HOME");
  if (caches.is_absolute()) return caches / "softpoint";
  const fs::path home = environment("HOME");
  return home.is_absolute() ? (home / ".cache" / "softpoint").string() : "";
}

CacheCounters cache_counters() { return {hits, misses, rejected, written, evicted}; }

std::string cache_path(const TriangleMesh& mesh, double poisson, const StiffnessSettings& settings,
                       const CacheSettings& cache) {
  if (cache.folder.empty()) return {};
  return file_of(cache, cache_key(described(mesh, poisson, settings), settings.keep_traction));
}

std::shared_ptr<const BoundaryStiffness> load_or_assemble_stiffness(const TriangleMesh& mesh, double poisson,
                                                                    const StiffnessSettings& settings,
                                                                    const CacheSettings& cache) {
  check(settings);
  check(cache);
  check_poisson("material.poisson", poisson);
  if (cache.folder.empty()) {
    ++misses;
    return assemble_stiffness(mesh, poisson, settings);
  }
  Stopwatch watch;
  auto model = std::make_shared<BoundaryStiffness>(described(mesh, poisson, settings));
  const std::string key = cache_key(*model, settings.keep_traction);
  const fs::path path = file_of(cache, key);
  const CacheRead read = read_cache_file(path, key, settings.keep_traction, *model);
  if (read == CacheRead::kFound) {
    ++hits;
    ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0);  // the last use; may fail in a read-only folder
    model->from_cache = true;
    model->seconds.cache = model->seconds.total = watch.lap();
    return model;
  }
  ++misses;
  if (read == CacheRead::kRejected) ++rejected;
  double cache_seconds = watch.lap();
  model.reset();
  model = assemble(mesh, poisson, settings);
  watch.lap();
  if (keep(path, key, *model, cache)) ++written;
  cache_seconds += watch.lap();
  model->seconds.cache = cache_seconds;
  model->seconds.total += cache_seconds;
  return model;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

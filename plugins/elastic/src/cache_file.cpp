#include "cache_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "word_hash.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

// Raise it whenever the layout below or any result of assemble_stiffness changes.
constexpr std::uint32_t kVersion = 1;
constexpr std::uint64_t kChecksumSeed = 0x736f6674, kDigestSeeds[2] = {0x706f696e, 0x74657221};

struct Header {
  char magic[8] = {'S', 'O', 'F', 'T', 'P', 'N', 'T', 'S'};
  std::uint32_t version = kVersion;
  std::uint32_t byte_order = 0x01020304;
  std::uint64_t key_bytes = 0;
  std::uint64_t stiffness = 0, gravity = 0, traction = 0;  // doubles
  std::uint64_t checksum = 0;                              // of all else: header with 0 here, key, payload
};
static_assert(std::is_trivially_copyable_v<Header> && sizeof(Header) == 56);

class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }
  bool close() { return ::close(std::exchange(descriptor_, -1)) == 0; }

  bool read(void* data, std::size_t bytes) const {
    auto* at = static_cast<char*>(data);
    while (bytes > 0) {
      const ssize_t got = ::read(descriptor_, at, bytes);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      at += got;
      bytes -= static_cast<std::size_t>(got);
    }
    return true;
  }

  bool write(const void* data, std::size_t bytes) const {
    const auto* at = static_cast<const char*>(data);
    while (bytes > 0) {
      const ssize_t put = ::write(descriptor_, at, bytes);
      if (put < 0 && errno == EINTR) continue;
      if (put <= 0) return false;
      at += put;
      bytes -= static_cast<std::size_t>(put);
    }
    return true;
  }

 private:
  int descriptor_;
};

Header expected_header(const BoundaryStiffness& model, const std::string& key, bool keep_traction) {
  const std::uint64_t rows = 3 * static_cast<std::uint64_t>(model.mesh.vertex_count());
  const std::uint64_t faces = 3 * static_cast<std::uint64_t>(model.mesh.triangle_count());
  Header header;
  header.key_bytes = key.size();
  header.stiffness = rows * rows;
  header.gravity = 3 * rows;
  header.traction = keep_traction ? faces * rows : 0;
  return header;
}

std::uint64_t checksum(const Header& header, const std::string& key, const BoundaryStiffness& model) {
  Header blank = header;
  blank.checksum = 0;
  WordHash hash(kChecksumSeed);
  hash.add(&blank, sizeof blank);
  hash.add(key.data(), key.size());
  for (const auto* part : {&model.unit_stiffness, &model.gravity_columns, &model.unit_traction}) {
    hash.add(part->data(), part->size() * sizeof(double));
  }
  return hash.value();
}

template <class T>
void append(std::string& key, const T& value) {
  static_assert(std::is_arithmetic_v<T>);
  key.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

std::string cache_key(const BoundaryStiffness& model, bool keep_traction) {
  std::string key;
  append(key, kVersion);
  append(key, static_cast<std::int32_t>(model.instruction_set));
  append(key, static_cast<std::int32_t>(keep_traction));
  append(key, model.poisson);
  append(key, model.quadrature.far_points);
  append(key, model.quadrature.near_points);
  append(key, model.quadrature.near_graded_order);
  append(key, model.quadrature.near_distance);
  append(key, model.mesh.vertex_count());
  append(key, model.mesh.triangle_count());
  for (const Vec3& x : model.mesh.vertices) {
    for (double component : x) append(key, component);
  }
  for (const Triangle& t : model.mesh.triangles) {
    for (int vertex : t) append(key, vertex);
  }
  return key;
}

std::string key_digest(const std::string& key) {
  std::string digest;
  for (std::uint64_t seed : kDigestSeeds) {
    WordHash hash(seed);
    hash.add(key.data(), key.size());
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash.value()));
    digest += text;
  }
  return digest;
}

std::size_t cache_file_bytes(const BoundaryStiffness& model, const std::string& key, bool keep_traction) {
  const Header header = expected_header(model, key, keep_traction);
  return sizeof header + key.size() + sizeof(double) * (header.stiffness + header.gravity + header.traction);
}

CacheRead read_cache_file(const std::filesystem::path& path, const std::string& key, bool keep_traction,
                          BoundaryStiffness& model) {
  // Not blocking: the name could belong to a pipe.
  const File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.is_open()) return errno == ENOENT ? CacheRead::kMissing : CacheRead::kRejected;
  struct stat status;
  if (::fstat(file.descriptor(), &status) != 0 || !S_ISREG(status.st_mode) ||
      static_cast<std::size_t>(status.st_size) != cache_file_bytes(model, key, keep_traction)) {
    return CacheRead::kRejected;
  }
  Header header;
  Header expected = expected_header(model, key, keep_traction);
  std::string found(key.size(), '\0');
  if (!file.read(&header, sizeof header) || !file.read(found.data(), found.size()) || found != key) {
    return CacheRead::kRejected;
  }
  expected.checksum = header.checksum;
  if (std::memcmp(&header, &expected, sizeof header) != 0) return CacheRead::kRejected;
  model.unit_stiffness.resize(header.stiffness);
  model.gravity_columns.resize(header.gravity);
  model.unit_traction.resize(header.traction);
  for (auto* part : {&model.unit_stiffness, &model.gravity_columns, &model.unit_traction}) {
    if (!file.read(part->data(), part->size() * sizeof(double))) return CacheRead::kRejected;
  }
  return checksum(header, key, model) == header.checksum ? CacheRead::kFound : CacheRead::kRejected;
}

bool write_cache_file(const std::filesystem::path& path, const std::string& key,
                      const BoundaryStiffness& model) {
  Header header = expected_header(model, key, !model.unit_traction.empty());
  header.checksum = checksum(header, key, model);
  std::string part = path.string() + kPartSuffix + "XXXXXX";
  File file(::mkostemp(part.data(), O_CLOEXEC));
  if (!file.is_open()) return false;
  bool good = file.write(&header, sizeof header) && file.write(key.data(), key.size());
  for (const auto* values : {&model.unit_stiffness, &model.gravity_columns, &model.unit_traction}) {
    good = good && file.write(values->data(), values->size() * sizeof(double));
  }
  good = good && ::fsync(file.descriptor()) == 0;
  good = file.close() && good;
  good = good && ::rename(part.c_str(), path.c_str()) == 0;
  if (!good) ::unlink(part.c_str());
  return good;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#include "softpoint/core/snapshot.h"

#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include <LinearMath/btScalar.h>

#include "snapshot_bytes.h"
#include "softpoint/core/atomic_file.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

constexpr const char* kPermitted = "; permitted is a whole snapshot as save() made it";

[[noreturn]] void refuse(const std::string& reason) { throw Error("snapshot: " + reason + kPermitted); }

void check_header(std::span<const std::byte> bytes) {
  if (bytes.size() < kSnapshotHeader) {
    refuse(std::to_string(bytes.size()) + " bytes are less than its header");
  }
  std::vector<std::byte> fitting(bytes.begin(), bytes.begin() + kSnapshotHeader);
  seal_snapshot(fitting);
  const auto differs = [&](SnapshotWord word) { return get_word(bytes, word) != get_word(fitting, word); };
  if (differs(SnapshotWord::magic)) {
    refuse("it does not begin as one");
  }
  if (differs(SnapshotWord::version)) {
    throw Error("snapshot: version " + std::to_string(get_word(bytes, SnapshotWord::version)) +
                "; permitted is " + std::to_string(kSnapshotVersion));
  }
  if (differs(SnapshotWord::precision)) {
    throw Error("snapshot: precision of " + std::to_string(get_word(bytes, SnapshotWord::precision)) +
                " bytes a number; permitted is that of this build, " + std::to_string(sizeof(btScalar)));
  }
  if (get_word(bytes, SnapshotWord::size) != bytes.size() || bytes.size() % 8 != 0) {
    refuse("its header tells " + std::to_string(get_word(bytes, SnapshotWord::size)) + " bytes, there are " +
           std::to_string(bytes.size()));
  }
  if (get_word(bytes, SnapshotWord::checksum) != snapshot_checksum(bytes)) {
    refuse("its checksum does not fit its content");
  }
}

}  // namespace

Snapshot read_snapshot(std::span<const std::byte> bytes) {
  check_header(bytes);
  Snapshot snapshot;
  snapshot.bytes_.assign(bytes.begin(), bytes.end());
  return snapshot;
}

Snapshot read_snapshot(const std::filesystem::path& path) {
  std::error_code error;
  std::ifstream in(path, std::ios::binary);
  if (!std::filesystem::is_regular_file(path, error) || !in) {
    throw Error(path.string() + ": no file that can be read; permitted is a snapshot");
  }
  const std::string content((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  try {
    return read_snapshot(std::as_bytes(std::span(content)));
  } catch (const Error& refusal) {
    throw Error(path.string() + ": " + refusal.what());
  }
}

void write_snapshot(const std::filesystem::path& path, const Snapshot& snapshot) {
  const std::span<const std::byte> bytes = snapshot.bytes();
  if (bytes.empty()) {
    throw Error(path.string() + ": the snapshot is empty; permitted is one that save() made");
  }
  write_atomically(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace softpoint::inline SOFTPOINT_ABI

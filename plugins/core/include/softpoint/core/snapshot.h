#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// What a snapshot holds.
enum class SnapshotScope {
  deformables,  // everything of a DeformableSystem
  world         // and the motion and sleep of Bullet's rigid bodies and multibodies
};

// The state of a DeformableSystem between two steps: a value, made by DeformableSystem::save() or
// read_snapshot(). It holds no pointers: bodies are known by their place in the system, colliders by their
// place in the world's array of collision objects.
class SOFTPOINT_API Snapshot {
 public:
  // As in a file: header, checksum, state.
  std::span<const std::byte> bytes() const { return bytes_; }
  // Nothing saved yet.
  bool empty() const { return bytes_.empty(); }

 private:
  friend class DeformableSystem;
  friend SOFTPOINT_API Snapshot read_snapshot(std::span<const std::byte> bytes);

  template <class Describe>
  void write(Describe describe);
  template <class Describe>
  void take(Describe describe) const;

  std::vector<std::byte> bytes_;
};

// Throws Error, naming what is wrong, for anything but a whole and unharmed snapshot of this version and of
// this precision of Bullet. Whether it fits a system is for DeformableSystem::restore() to say.
SOFTPOINT_API Snapshot read_snapshot(std::span<const std::byte> bytes);
// The same from a file.
SOFTPOINT_API Snapshot read_snapshot(const std::filesystem::path& path);
// Replaces the file at once or not at all. Throws Error naming the file and the reason.
SOFTPOINT_API void write_snapshot(const std::filesystem::path& path, const Snapshot& snapshot);

}  // namespace softpoint::inline SOFTPOINT_ABI

// Snapshots. An input is a list of changes to a good one, a line each:
//   set <word> <value>  a 64-bit word after the header, as an integer
//   real <word> <value> the same, as a double
//   byte <at> <value>
//   cut <words>         the snapshot ends there
//   add <value>         a word more at the end
//   open                header and checksum stay as they were; else they are made to fit
// It is refused and changes nothing, or it is taken over and the world goes on.
#include <cstring>
#include <sstream>
#include <vector>

#include "fuzz/fuzz_support.h"
#include "snapshot_bytes.h"
#include "softpoint/core/deformable_system.h"
#include "softpoint/core/error.h"
#include "support/particles.h"
#include "support/worlds.h"

using namespace softpoint;

namespace {

using Bytes = std::vector<std::byte>;

// A body held by a handle above a box on the floor.
struct Scene {
  Scene() {
    world.add_floor();
    world.add_box(Vec3(0.5, 0.1, 0.5), 2.0, Vec3(0, 0.1, 0));
    system.add(body);
    system.grab(body, 0, Vec3(0.1, 0.5, 0.1), 20.0);
    world.step(6);
  }

  Bytes state() const {
    const Snapshot saved = system.save(SnapshotScope::world);
    return {saved.bytes().begin(), saved.bytes().end()};
  }

  TestWorld world;
  Particles body = Particles::tetrahedron(Vec3(0, 0.4, 0));
  DeformableSystem system{*world};
};

Bytes changed(Bytes bytes, const std::string& changes) {
  const std::size_t most = bytes.size() + 4096;
  bool sealed = true;
  std::istringstream lines(changes);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string what;
    std::size_t at = 0;
    words >> what >> at;
    const std::size_t offset = kSnapshotHeader + 8 * (at % (1 << 20));
    if (what == "set" || what == "real") {
      std::uint64_t word = 0;
      if (what == "set") {
        long long value = 0;
        words >> value;
        word = static_cast<std::uint64_t>(value);
      } else {
        std::string text;
        words >> text;
        const double value = std::strtod(text.c_str(), nullptr);  // knows nan and inf
        std::memcpy(&word, &value, sizeof word);
      }
      if (offset + 8 <= bytes.size()) put_word(bytes, offset, word);
    } else if (what == "byte") {
      int value = 0;
      words >> value;
      if (at < bytes.size()) bytes[at] = static_cast<std::byte>(value);
    } else if (what == "cut") {
      if (offset < bytes.size()) bytes.resize(offset);
    } else if (what == "add") {
      if (bytes.size() < most) {
        bytes.resize(bytes.size() + 8);
        put_word(bytes, bytes.size() - 8, at);
      }
    } else if (what == "open") {
      sealed = false;
    }
  }
  if (sealed && bytes.size() >= kSnapshotHeader) seal_snapshot(bytes);
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 1 << 12) return 0;
  Scene scene;
  const Bytes before = scene.state();
  const Bytes bytes = changed(before, std::string(reinterpret_cast<const char*>(data), size));
  try {
    const Snapshot snapshot = read_snapshot(bytes);
    scene.system.restore(snapshot);
  } catch (const Error&) {
    fuzz::require(scene.state() == before, "what is refused changes nothing");
    return 0;
  }
  scene.world.step(2);
  for (const Vec3& point : scene.body.points()) fuzz::require(point.allFinite(), "points stay finite");
  return 0;
}

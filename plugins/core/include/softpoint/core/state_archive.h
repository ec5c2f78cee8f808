#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "softpoint/core/config.h"
#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI {

// The one description of a state that serves three purposes: to write it, to check what was written against
// what is permitted here, and to take it over. A plugin lists its members in archive_state(); each call names
// a member for the messages of errors. Checking changes nothing; taking over happens only after the whole
// snapshot has been checked.
//
// Every value takes whole 64-bit words in little-endian order: numbers as IEEE doubles, the rest as integers.
class SOFTPOINT_API StateArchive {
 public:
  // Values are taken over, so that what depends on them is to be brought into line.
  bool loading() const { return mode_ == Mode::load; }

  // The part that the next members belong to, for messages: "body 2".
  void begin(const char* part, long long index = -1);

  // A finite number within [low, high]; infinity where it is a bound. Throws Error in a snapshot that
  // disagrees, as do all below.
  void number(const char* name, double& value, double low = -kMost, double high = kMost);
  // An integer within [low, high].
  void integer(const char* name, long long& value, long long low, long long high);
  // The same for a plain int.
  void integer(const char* name, int& value, int low, int high);
  // True or false.
  void flag(const char* name, bool& value);
  // The same, known while checking too: for what decides which members follow.
  void read_flag(const char* name, bool& value);
  // Three finite numbers.
  void vector(const char* name, Vec3& value);
  // A rotation matrix.
  void rotation(const char* name, Mat3& value);
  // As many finite vectors as there are now.
  void vectors(const char* name, std::vector<Vec3>& values);

  // What cannot be taken over has to be the same here, bit for bit.
  void constant(const char* name, double value);
  // The same for a count or a hash.
  void constant(const char* name, std::uint64_t value);
  // The same for a name.
  void constant(const char* name, std::string_view value);

  // A list of any length up to `limit`: `item` archives one of its entries. While checking, entries are read
  // into one that is thrown away.
  template <class T, class Item>
  void list(const char* name, std::vector<T>& entries, long long limit, Item item) {
    const std::size_t count = list_size(name, entries.size(), limit);
    if (mode_ == Mode::check) {
      mode_ = Mode::load;
      for (std::size_t i = 0; i < count; ++i) {
        T scratch{};
        item(scratch);
      }
      mode_ = Mode::check;
      return;
    }
    if (mode_ == Mode::load) {
      entries.resize(count);
    }
    for (T& entry : entries) {
      if (mode_ == Mode::load) {
        entry = T{};
      }
      item(entry);
    }
  }

  // Throws Error: "<part>: <name>: <reason>".
  [[noreturn]] void refuse(const char* name, const std::string& reason) const;

 private:
  friend class Snapshot;
  enum class Mode { save, check, load };
  static constexpr double kMost = 1.7976931348623157e308;

  explicit StateArchive(std::vector<std::byte>& out) : mode_(Mode::save), out_(&out) {}
  StateArchive(std::span<const std::byte> in, Mode mode) : mode_(mode), in_(in) {}

  std::uint64_t word(const char* name, std::uint64_t value);
  std::size_t list_size(const char* name, std::size_t present, long long limit);

  Mode mode_;
  std::vector<std::byte>* out_ = nullptr;
  std::span<const std::byte> in_;
  std::size_t offset_ = 0;
  const char* part_ = "snapshot";
  long long part_index_ = -1;
};

// FNV-1a, to tell whether large constants agree.
SOFTPOINT_API std::uint64_t state_hash(const void* data, std::size_t bytes,
                                       std::uint64_t seed = 0xcbf29ce484222325u);

}  // namespace softpoint::inline SOFTPOINT_ABI

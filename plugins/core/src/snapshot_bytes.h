#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "softpoint/core/config.h"

// The frame round the state in a snapshot: five words of header.
namespace softpoint::inline SOFTPOINT_ABI {

inline constexpr std::uint64_t kSnapshotMagic = 0x50414E534E505453;  // "STPNSNAP" in a file
// Raise it whenever any state is written otherwise.
inline constexpr std::uint64_t kSnapshotVersion = 1;

enum class SnapshotWord : std::size_t { magic, version, precision, size, checksum, count };
inline constexpr std::size_t kSnapshotHeader = 8 * static_cast<std::size_t>(SnapshotWord::count);

// Bounds of what has no bound of its own.
inline constexpr double kMost = std::numeric_limits<double>::max();
inline constexpr int kMostInt = std::numeric_limits<int>::max();
inline constexpr long long kMostLong = std::numeric_limits<long long>::max();

inline std::uint64_t to_little_endian(std::uint64_t word) {
  if constexpr (std::endian::native == std::endian::big) {
    word = __builtin_bswap64(word);
  }
  return word;
}

inline std::uint64_t get_word(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return to_little_endian(word);
}

inline void put_word(std::span<std::byte> bytes, std::size_t offset, std::uint64_t word) {
  word = to_little_endian(word);
  std::memcpy(bytes.data() + offset, &word, sizeof word);
}

inline std::uint64_t get_word(std::span<const std::byte> bytes, SnapshotWord which) {
  return get_word(bytes, 8 * static_cast<std::size_t>(which));
}

inline void put_word(std::span<std::byte> bytes, SnapshotWord which, std::uint64_t word) {
  put_word(bytes, 8 * static_cast<std::size_t>(which), word);
}

// Of all words but the checksum's own. Every step is a bijection of the word it takes in, so that a change
// within one word never goes unnoticed.
inline std::uint64_t snapshot_checksum(std::span<const std::byte> bytes) {
  constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15u;  // 2^64 over the golden ratio
  std::uint64_t state = 0x534e4150u;
  for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) {
    if (at != 8 * static_cast<std::size_t>(SnapshotWord::checksum)) {
      state = std::rotl((state ^ get_word(bytes, at)) * kOdd, 29);
    }
  }
  return state ^ (state >> 31);
}

// Gives the bytes a header that fits them.
inline void seal_snapshot(std::span<std::byte> bytes) {
  put_word(bytes, SnapshotWord::magic, kSnapshotMagic);
  put_word(bytes, SnapshotWord::version, kSnapshotVersion);
#if defined(BT_USE_DOUBLE_PRECISION)
  put_word(bytes, SnapshotWord::precision, 8);
#else
  put_word(bytes, SnapshotWord::precision, 4);
#endif
  put_word(bytes, SnapshotWord::size, bytes.size());
  put_word(bytes, SnapshotWord::checksum, snapshot_checksum(bytes));
}

}  // namespace softpoint::inline SOFTPOINT_ABI

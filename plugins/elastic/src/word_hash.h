#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// A fast 64-bit checksum, not cryptographic. Every step is a bijection of the word it takes in, so any
// change confined to one 8-byte word is found for certain; others with probability 1 - 2^-64.
class WordHash {
 public:
  explicit WordHash(std::uint64_t seed) {
    for (std::size_t i = 0; i < lane_.size(); ++i) lane_[i] = mix(seed + kOdd * (i + 1));
  }

  void add(const void* data, std::size_t bytes) {
    const auto* at = static_cast<const unsigned char*>(data);
    std::uint64_t word[4];
    for (; bytes >= sizeof word; bytes -= sizeof word, at += sizeof word, length_ += sizeof word) {
      std::memcpy(word, at, sizeof word);
      for (std::size_t i = 0; i < 4; ++i) lane_[i] = absorb(lane_[i], word[i]);
    }
    length_ += bytes;
    for (std::size_t lane = 0; bytes > 0; ++lane) {
      const std::size_t part = bytes < 8 ? bytes : 8;
      word[0] = 0;
      std::memcpy(word, at, part);
      lane_[lane] = absorb(lane_[lane], word[0]);
      at += part;
      bytes -= part;
    }
  }

  std::uint64_t value() const {
    std::uint64_t result = mix(length_);
    for (std::uint64_t lane : lane_) result = absorb(result, mix(lane));
    return mix(result);
  }

 private:
  static constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15u;  // 2^64 over the golden ratio

  static std::uint64_t absorb(std::uint64_t state, std::uint64_t word) {
    return std::rotl((state ^ word) * kOdd, 29);
  }
  static std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 31)) * kOdd;
    x = (x ^ (x >> 29)) * kOdd;
    return x ^ (x >> 32);
  }

  std::array<std::uint64_t, 4> lane_;
  std::uint64_t length_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#include "softpoint/core/state_archive.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "snapshot_bytes.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

constexpr double kFarthest = 1e30;   // of a component of a vector: it has to fit Bullet's numbers too
constexpr double kNotTurned = 1e-3;  // distance from a rotation matrix that is still one, in single precision

}  // namespace

void StateArchive::begin(const char* part, long long index) {
  part_ = part;
  part_index_ = index;
}

void StateArchive::refuse(const char* name, const std::string& reason) const {
  throw Error("snapshot: " + std::string(part_) +
              (part_index_ >= 0 ? " " + std::to_string(part_index_) : std::string()) + ": " + name + ": " +
              reason);
}

std::uint64_t StateArchive::word(const char* name, std::uint64_t value) {
  if (mode_ == Mode::save) {
    const std::size_t at = out_->size();
    out_->resize(at + 8);
    put_word(*out_, at, value);
    return value;
  }
  if (in_.size() - offset_ < 8) {
    refuse(name, "missing, the snapshot ends here; permitted is a snapshot of this very system");
  }
  value = get_word(in_, offset_);
  offset_ += 8;
  return value;
}

void StateArchive::number(const char* name, double& value, double low, double high) {
  const double found = std::bit_cast<double>(word(name, std::bit_cast<std::uint64_t>(value)));
  if (mode_ == Mode::save) {
    return;
  }
  if (!(found >= low && found <= high)) {
    refuse(name, to_text(found) + "; permitted is " + to_text(low) + " to " + to_text(high));
  }
  if (loading()) {
    value = found;
  }
}

void StateArchive::integer(const char* name, long long& value, long long low, long long high) {
  const auto found = static_cast<long long>(word(name, static_cast<std::uint64_t>(value)));
  if (mode_ == Mode::save) {
    return;
  }
  if (found < low || found > high) {
    refuse(name,
           std::to_string(found) + "; permitted is " + std::to_string(low) + " to " + std::to_string(high));
  }
  if (loading()) {
    value = found;
  }
}

void StateArchive::integer(const char* name, int& value, int low, int high) {
  long long wide = value;
  integer(name, wide, low, high);
  value = static_cast<int>(wide);
}

void StateArchive::flag(const char* name, bool& value) {
  long long wide = value;
  integer(name, wide, 0, 1);
  value = wide != 0;
}

void StateArchive::read_flag(const char* name, bool& value) {
  const Mode mode = mode_;
  mode_ = mode == Mode::check ? Mode::load : mode;
  flag(name, value);
  mode_ = mode;
}

void StateArchive::vector(const char* name, Vec3& value) {
  for (double& component : value) {
    number(name, component, -kFarthest, kFarthest);
  }
}

void StateArchive::rotation(const char* name, Mat3& value) {
  Mat3 found = value;
  const Mode mode = mode_;
  if (mode_ == Mode::check) {
    mode_ = Mode::load;
  }
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      number(name, found(row, column), -2.0, 2.0);
    }
  }
  mode_ = mode;
  if (mode_ != Mode::save && !((found.transpose() * found - Mat3::Identity()).norm() < kNotTurned)) {
    refuse(name, "no rotation matrix; permitted is one");
  }
  if (loading()) {
    value = found;
  }
}

void StateArchive::vectors(const char* name, std::vector<Vec3>& values) {
  constant(name, static_cast<std::uint64_t>(values.size()));
  for (Vec3& value : values) {
    vector(name, value);
  }
}

void StateArchive::constant(const char* name, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const std::uint64_t found = word(name, bits);
  if (found != bits) {
    refuse(name, to_text(std::bit_cast<double>(found)) + " in the snapshot; permitted is " + to_text(value) +
                     ", as here");
  }
}

void StateArchive::constant(const char* name, std::uint64_t value) {
  const std::uint64_t found = word(name, value);
  if (found != value) {
    refuse(name,
           std::to_string(found) + " in the snapshot; permitted is " + std::to_string(value) + ", as here");
  }
}

void StateArchive::constant(const char* name, std::string_view value) {
  constant(name, static_cast<std::uint64_t>(value.size()));
  for (std::size_t at = 0; at < value.size(); at += 8) {
    std::uint64_t letters = 0;
    for (std::size_t k = 0; k < 8 && at + k < value.size(); ++k) {
      letters |= static_cast<std::uint64_t>(static_cast<unsigned char>(value[at + k])) << (8 * k);
    }
    if (word(name, letters) != letters) {
      refuse(name, "another one in the snapshot; permitted is \"" + std::string(value) + "\", as here");
    }
  }
}

std::size_t StateArchive::list_size(const char* name, std::size_t present, long long limit) {
  long long size = static_cast<long long>(present);
  if (mode_ == Mode::save) {
    word(name, static_cast<std::uint64_t>(size));
    return present;
  }
  const Mode mode = mode_;
  mode_ = Mode::load;
  // No entry takes less than a word.
  integer(name, size, 0, std::min(limit, static_cast<long long>((in_.size() - offset_) / 8)));
  mode_ = mode;
  return static_cast<std::size_t>(size);
}

std::uint64_t state_hash(const void* data, std::size_t bytes, std::uint64_t seed) {
  const auto* at = static_cast<const unsigned char*>(data);
  std::uint64_t hash = seed;
  for (std::size_t i = 0; i < bytes; ++i) {
    hash = (hash ^ at[i]) * 0x100000001b3u;  // FNV-1a
  }
  return hash;
}

}  // namespace softpoint::inline SOFTPOINT_ABI

#pragma once

#include <cstdint>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Doubles aligned to the widest pack.
class PackArray {
 public:
  static constexpr std::size_t kPackBytes = 64;

  void resize(std::size_t size) { storage_.assign(size + kPackBytes / sizeof(double), 0.0); }
  double* data() {
    const auto at = reinterpret_cast<std::uintptr_t>(storage_.data());
    return storage_.data() + ((kPackBytes - at % kPackBytes) % kPackBytes) / sizeof(double);
  }
  const double* data() const { return const_cast<PackArray*>(this)->data(); }

 private:
  std::vector<double> storage_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

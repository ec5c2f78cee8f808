#pragma once

#include <chrono>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Wall time since construction or the last lap, s.
class Stopwatch {
 public:
  double lap() {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

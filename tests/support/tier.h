#pragma once

#include <cstdlib>
#include <string_view>

namespace softpoint {

// The long tier: tests/run.sh --full.
inline bool full_tier() {
  const char* value = std::getenv("SOFTPOINT_TEST_FULL");
  return value != nullptr && std::string_view(value) == "1";
}

// Under ASan and UBSan, 20 times slower: a test of errors of memory and of language, not of time or accuracy.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kInstrumented = true;
#else
inline constexpr bool kInstrumented = false;
#endif

// How often something is tried: in the long tier, in the short one, and where it is instrumented.
inline int by_tier(int full, int brief, int instrumented) {
  return full_tier() ? full : kInstrumented ? instrumented : brief;
}

}  // namespace softpoint

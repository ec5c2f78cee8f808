#pragma once

// One inline namespace per Bullet precision. Most of Bullet's own soft-body symbols have
// the same mangled name in both precisions; ours differ, so mixing them fails at link time
// instead of at run time.
#if defined(BT_USE_DOUBLE_PRECISION)
#define SOFTPOINT_ABI abi_float64
#else
#define SOFTPOINT_ABI abi_float32
#endif

// What a shared library shows to programs; everything else of it is hidden.
#if defined(__GNUC__)
#define SOFTPOINT_API __attribute__((visibility("default")))
#else
#define SOFTPOINT_API
#endif

namespace softpoint::inline SOFTPOINT_ABI {

inline constexpr int kVersionMajor = 0;
inline constexpr int kVersionMinor = 1;
inline constexpr int kVersionPatch = 0;

}  // namespace softpoint::inline SOFTPOINT_ABI

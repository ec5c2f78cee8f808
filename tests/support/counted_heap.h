#pragma once

// Replaces operator new by one that counts. For one source of an executable: all of its others share the
// count by counted_heap_calls.h.

#include <cstdlib>
#include <new>

#include "support/counted_heap_calls.h"

namespace softpoint::test {

std::atomic<long long> heap_calls{0};

inline void* counted_or_null(std::size_t size) noexcept {
  ++heap_calls;
  return std::malloc(size == 0 ? 1 : size);
}
inline void* counted(std::size_t size) {
  if (void* p = counted_or_null(size)) return p;
  throw std::bad_alloc();
}
inline void* counted_aligned(std::size_t size, std::align_val_t alignment) {
  ++heap_calls;
  const auto a = static_cast<std::size_t>(alignment);
  if (void* p = std::aligned_alloc(a, (size + a - 1) / a * a)) return p;
  throw std::bad_alloc();
}

}  // namespace softpoint::test

// Not inlined: seen side by side, malloc and operator delete look mismatched to the compiler.
[[gnu::noinline]] void* operator new(std::size_t size) { return softpoint::test::counted(size); }
[[gnu::noinline]] void* operator new[](std::size_t size) { return softpoint::test::counted(size); }
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return softpoint::test::counted_or_null(size);
}
[[gnu::noinline]] void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return softpoint::test::counted_or_null(size);
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t a) {
  return softpoint::test::counted_aligned(size, a);
}
[[gnu::noinline]] void* operator new[](std::size_t size, std::align_val_t a) {
  return softpoint::test::counted_aligned(size, a);
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete[](void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

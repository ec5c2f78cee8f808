#pragma once

// Counts every call that takes from the heap: malloc and its like, on which operator new stands, and which
// Eigen calls by itself. For one source of an executable, as counted_heap.h, whose operator new alone counts
// where malloc cannot be replaced: under sanitizers, which replace it themselves, and without glibc.
#include "support/counted_heap_calls.h"
#include "support/tier.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)

#include <cerrno>
#include <cstddef>

namespace softpoint::test {
std::atomic<long long> heap_calls{0};
}

extern "C" {
void* __libc_malloc(std::size_t size) noexcept;
void* __libc_calloc(std::size_t count, std::size_t size) noexcept;
void* __libc_realloc(void* p, std::size_t size) noexcept;
void* __libc_memalign(std::size_t alignment, std::size_t size) noexcept;

void* malloc(std::size_t size) noexcept {
  ++softpoint::test::heap_calls;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++softpoint::test::heap_calls;
  return __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) noexcept {
  ++softpoint::test::heap_calls;
  return __libc_realloc(p, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++softpoint::test::heap_calls;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept { return memalign(alignment, size); }
int posix_memalign(void** p, std::size_t alignment, std::size_t size) noexcept {
  *p = memalign(alignment, size);
  return *p == nullptr ? ENOMEM : 0;
}
}

#else
#include "support/counted_heap.h"
#endif

#pragma once

#include <atomic>

namespace softpoint::test {

// Calls of operator new since the program began; counted_heap.h makes them count, counted_malloc.h those of malloc.
extern std::atomic<long long> heap_calls;

}  // namespace softpoint::test

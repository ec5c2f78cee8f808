#pragma once

#include <atomic>

namespace softpoint::test {

// Calls of operator new since the program began; counted_heap.h makes them count.
extern std::atomic<long long> heap_calls;

}  // namespace softpoint::test

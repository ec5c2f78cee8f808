#pragma once

// Calls of operator new since the program began; air_heap_test.cpp replaces it.
extern long long cloth_heap_calls;

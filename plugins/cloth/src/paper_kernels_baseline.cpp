// For any processor: vectors of 16 bytes, no fused operations.
#define SOFTPOINT_PAPER_NAME paper_kernels_baseline
#define SOFTPOINT_PAPER_BYTES 16
#include "paper_kernels-inl.h"

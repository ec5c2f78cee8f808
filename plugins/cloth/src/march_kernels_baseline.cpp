// For any processor: 16 bytes, no fused operations.
#define SOFTPOINT_KERNEL_NAME march_kernels_baseline
#define SOFTPOINT_KERNEL_BYTES 16
#include "march_kernels-inl.h"

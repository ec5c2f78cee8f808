// For any processor: 16 bytes, no fused operations.
#define SOFTPOINT_KERNEL_NAME sweep_kernels_baseline
#define SOFTPOINT_KERNEL_BYTES 16
#include "sweep_kernels-inl.h"

// For any processor: two lanes, no fused operations.
#define SOFTPOINT_KERNEL_NAME kernels_baseline
#define SOFTPOINT_KERNEL_LANES 2
#include "kernels-inl.h"

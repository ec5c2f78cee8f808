#define SOFTPOINT_KERNEL_NAME crowd_kernel_baseline
#define SOFTPOINT_KERNEL_FORWARD crowd_forward_baseline
#define SOFTPOINT_KERNEL_LANES 2
#include "crowd_kernel-inl.h"

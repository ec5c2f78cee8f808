#define SOFTPOINT_WALK forward_walker_baseline
#define SOFTPOINT_WALK_SCALAR Scalar = double
#include "forward_walk-inl.h"

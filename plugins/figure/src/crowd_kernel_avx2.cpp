// The pragma does what the -m flags would, so that a plain compiler line without flags for single files
// builds this variant too. Products and sums may be rounded once: results are bit-identical within one
// instruction set only.
#include "softpoint/core/instruction_set.h"

#if SOFTPOINT_HAS_X86_KERNELS
#pragma GCC target("avx2,fma")
#pragma GCC optimize("fp-contract=fast")
#define SOFTPOINT_KERNEL_NAME crowd_kernel_avx2
#define SOFTPOINT_KERNEL_FORWARD crowd_forward_avx2
#define SOFTPOINT_KERNEL_LANES 4
#include "crowd_kernel-inl.h"
#else
#include "crowd_kernel.h"
namespace softpoint::inline SOFTPOINT_ABI::figure {
CrowdKernel crowd_kernel_avx2() { return crowd_kernel_baseline(); }
}  // namespace softpoint::inline SOFTPOINT_ABI::figure
#endif

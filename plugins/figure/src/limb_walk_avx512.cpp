// The pragma does what the -m flags would, so that a plain compiler line without flags for single files
// builds this variant too. Products and sums may be rounded once: results are bit-identical within one
// instruction set only.
#include "softpoint/core/instruction_set.h"

#if SOFTPOINT_HAS_X86_KERNELS
#pragma GCC target("avx512f,avx512dq,avx512vl,avx2,fma")
#pragma GCC optimize("fp-contract=fast")
#define SOFTPOINT_LIMB_NAME limb_walker_avx512
#define SOFTPOINT_LIMB_FORWARD limb_forward_avx512
#define SOFTPOINT_LIMB_LANES 8
#include "limb_walk-inl.h"
#else
#include "limb_walk.h"
namespace softpoint::inline SOFTPOINT_ABI::figure {
LimbWalker limb_walker_avx512() { return {}; }
}  // namespace softpoint::inline SOFTPOINT_ABI::figure
#endif

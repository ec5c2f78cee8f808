// For processors with AVX2 and FMA. The pragma does what the -m flags would, so that a plain compiler line
// without flags for single files builds this variant too. Products and sums are rounded once: results are
// bit-identical within one instruction set only.
#include "softpoint/core/instruction_set.h"

#if SOFTPOINT_HAS_X86_KERNELS
#pragma GCC target("avx2,fma")
// Packing neighbours into vectors costs more moves here than it saves.
#pragma GCC optimize("fp-contract=fast", "no-tree-slp-vectorize")
#include "fused_scalar.h"
#define SOFTPOINT_WALK forward_walker_avx2
#define SOFTPOINT_WALK_SCALAR Scalar = FusedScalar
#include "forward_walk-inl.h"
#else
#include "forward_walk.h"
namespace softpoint::inline SOFTPOINT_ABI::figure {
ForwardWalker forward_walker_avx2() { return forward_walker_baseline(); }
}  // namespace softpoint::inline SOFTPOINT_ABI::figure
#endif

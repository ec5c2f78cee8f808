// For processors with AVX2 and FMA.
#include "softpoint/core/instruction_set.h"
#if SOFTPOINT_HAS_X86_KERNELS
#pragma GCC target("avx2,fma")
#define SOFTPOINT_PAPER_NAME paper_kernels_avx2
#define SOFTPOINT_PAPER_BYTES 32
#include "paper_kernels-inl.h"
#else
#include "paper_kernels.h"
namespace softpoint::inline SOFTPOINT_ABI::cloth {
const PaperKernels* paper_kernels_avx2() { return nullptr; }
}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
#endif

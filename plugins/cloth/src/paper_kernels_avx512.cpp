// For processors with AVX-512 F, DQ and VL.
#include "softpoint/core/instruction_set.h"
#if SOFTPOINT_HAS_X86_KERNELS
#pragma GCC target("avx512f,avx512dq,avx512vl,avx2,fma")
#define SOFTPOINT_PAPER_NAME paper_kernels_avx512
#define SOFTPOINT_PAPER_BYTES 64
#include "paper_kernels-inl.h"
#else
#include "paper_kernels.h"
namespace softpoint::inline SOFTPOINT_ABI::cloth {
const PaperKernels* paper_kernels_avx512() { return nullptr; }
}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
#endif

// For processors with AVX2 and FMA. The pragma does what the -m flags would, so that a plain compiler line
// without flags for single files builds this variant too.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC target("avx2,fma")
#define SOFTPOINT_KERNEL_NAME march_kernels_avx2
#define SOFTPOINT_KERNEL_BYTES 32
#include "march_kernels-inl.h"
#else
#include "march_kernels.h"
namespace softpoint::inline SOFTPOINT_ABI::cloth {
const MarchKernelTable* march_kernels_avx2() { return nullptr; }
}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
#endif

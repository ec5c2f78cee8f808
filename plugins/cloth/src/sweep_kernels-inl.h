// The body of every sweep_kernels_*.cpp: SOFTPOINT_KERNEL_NAME and SOFTPOINT_KERNEL_BYTES are set before.
#include "sweep_kernels.h"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace softpoint::inline SOFTPOINT_ABI::cloth {
// Nameless, and the code calls nothing outside: no symbol but the table leaves this file.
namespace {

// Keeps the root of a square finite for springs of length 0, and changes no other.
template <class T>
constexpr T std_tiny() {
  return sizeof(T) == 4 ? T(1e-30) : T(1e-60);
}

#include "pack-inl.h"
// after pack
#include "gather-inl.h"
// after both
#include "move-inl.h"
#include "push-inl.h"

constexpr SweepKernelTable kKernels = {
    Of<float>::lanes,
    Of<double>::lanes,
    {measure_dampers<float>, gather_colour<float>, move_colour<float>, commit_colour<float>,
     push_colour<float>, push_along_colour<float>, volume_of_colour<float>, elastic_energy<float>},
    {measure_dampers<double>, gather_colour<double>, move_colour<double>, commit_colour<double>,
     push_colour<double>, push_along_colour<double>, volume_of_colour<double>, elastic_energy<double>}};

}  // namespace

const SweepKernelTable* SOFTPOINT_KERNEL_NAME() { return &kKernels; }

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

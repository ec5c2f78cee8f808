// The body of every kernels_*.cpp: SOFTPOINT_KERNEL_NAME and SOFTPOINT_KERNEL_LANES are set before.
#include "kernels.h"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace softpoint::inline SOFTPOINT_ABI::elastic {
// Nameless, and the code calls nothing outside: no symbol but the table leaves this file.
namespace {

#include "pack-inl.h"
// after pack
#include "layer_potentials-inl.h"
// after both
#include "dense-inl.h"
// after all
#include "block_product-inl.h"
#include "segment_frames-inl.h"
#include "symmetric_product-inl.h"

constexpr Kernels kKernels = {kLanes,
                              kRows* kDepth + kColumns* kDepth,
                              layer_potentials,
                              cholesky,
                              divide_transposed,
                              divide,
                              add_square,
                              add_product,
                              kStripRows<float>,
                              kStripRows<double>,
                              block_product<float>,
                              block_product<double>,
                              2 * kLanes,
                              kSymmetricPanel,
                              packed_symmetric_product,
                              symmetric_product,
                              sum_moments,
                              turn_back,
                              sum_forces,
                              turn_forces,
                              place_points<double>,
                              place_points<float>,
                              to_single,
                              to_double};

}  // namespace

const Kernels* SOFTPOINT_KERNEL_NAME() { return &kKernels; }

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

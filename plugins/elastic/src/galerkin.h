#pragma once

#include <vector>

#include "kernels.h"
#include "panels.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// The Galerkin matrices of doc/boundary_elements.md for a Young's modulus of 1 Pa, column-major.
struct GalerkinMatrices {
  std::vector<double> v;             // V, 3F x 3F, symmetric
  std::vector<double> w_transposed;  // W^T, 3V x 3F
  std::vector<double> d;             // D, 3V x 3V, symmetric but for rounding
  std::vector<double> single;        // F x F: double integral of 1/R, over 4 pi
};

// Stage 1: V, `single`, and in w_transposed the double layer and B/2 (the diagonal of every 3 x 3 block).
void integrate_layers(const Panels& panels, int vertices, double poisson, const Quadrature& quadrature,
                      const Kernels& kernels, GalerkinMatrices& matrices);

// Stage 2: symmetrises V and `single`, completes W^T, fills D, frees `single`.
void assemble_regularised(const Panels& panels, int vertices, double poisson, GalerkinMatrices& matrices);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

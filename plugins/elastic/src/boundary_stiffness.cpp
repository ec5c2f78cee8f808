#include "softpoint/elastic/boundary_stiffness.h"

#include <utility>

#include "affine_correction.h"
#include "assemble.h"
#include "galerkin.h"
#include "hanging_field.h"
#include "instruction_set.h"
#include "memory.h"
#include "softpoint/core/error.h"
#include "softpoint/elastic/material.h"
#include "stopwatch.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

// Equation (14): D becomes the lower triangle of S = D + W^T V^-1 W; W^T becomes (V^-1 W)^T if wanted.
void condense(const Kernels& kernels, std::ptrdiff_t faces3, std::ptrdiff_t vertices3, bool keep_traction,
              GalerkinMatrices& m) {
  std::vector<double> scratch(kernels.scratch);
  if (!kernels.cholesky(m.v.data(), faces3, faces3, scratch.data())) {
    throw Error(
        "mesh: its single layer matrix is not positive definite; permitted are triangles that "
        "neither intersect nor are thinner than rounding");
  }
  kernels.divide_transposed(m.w_transposed.data(), vertices3, vertices3, m.v.data(), faces3, faces3,
                            scratch.data());
  kernels.add_square(m.d.data(), vertices3, vertices3, m.w_transposed.data(), faces3, vertices3,
                     scratch.data());
  if (keep_traction) {
    kernels.divide(m.w_transposed.data(), vertices3, vertices3, m.v.data(), faces3, faces3, scratch.data());
  }
}

}  // namespace

void check(const StiffnessSettings& settings) {
  settings.quadrature.resolved(1);
  check_not_negative("settings.memory_limit", settings.memory_limit);
  check_range("settings.max_instruction_set", static_cast<int>(settings.max_instruction_set), 0,
              static_cast<int>(InstructionSet::kAvx512));
}

double stiffness_memory(int vertices, int triangles) {
  const double v = vertices, f = triangles;
  // V and the single layer, W, D; then panels, kernel scratch and the affine fields.
  return 8.0 * (10.0 * f * f + 9.0 * f * v + 9.0 * v * v) + 8.0 * (80.0 * f + 400.0 * v) + 2e6;
}

std::shared_ptr<BoundaryStiffness> assemble(const TriangleMesh& mesh, double poisson,
                                            const StiffnessSettings& settings) {
  check_closed(mesh);
  check_poisson("material.poisson", poisson);
  check(settings);
  auto result = std::make_shared<BoundaryStiffness>();
  result->quadrature = settings.quadrature.resolved(mesh.vertex_count());
  check_memory(mesh, stiffness_memory(mesh.vertex_count(), mesh.triangle_count()), settings.memory_limit);
  result->mesh = mesh;
  result->poisson = poisson;
  result->instruction_set = choose_instruction_set(settings.max_instruction_set);

  const Kernels& kernels = kernels_for(result->instruction_set);
  StiffnessSeconds& seconds = result->seconds;
  Stopwatch whole, stage;
  const Vec3 origin = mean_vertex(mesh);
  const Panels panels(mesh, origin);
  GalerkinMatrices matrices;
  integrate_layers(panels, mesh.vertex_count(), poisson, result->quadrature, kernels, matrices);
  seconds.quadrature = stage.lap();
  assemble_regularised(panels, mesh.vertex_count(), poisson, matrices);
  seconds.assembly = stage.lap();
  condense(kernels, 3 * mesh.triangle_count(), 3 * mesh.vertex_count(), settings.keep_traction, matrices);
  result->unit_stiffness = std::move(matrices.d);
  if (settings.keep_traction) result->unit_traction = std::move(matrices.w_transposed);
  seconds.condensation = stage.lap();

  std::vector<Vec3> points = mesh.vertices;
  for (Vec3& x : points) x -= origin;
  correct_affine(panels, points, poisson, result->unit_stiffness);
  result->gravity_columns = hanging_loads(mesh, origin, poisson, result->unit_stiffness);
  seconds.correction = stage.lap();
  seconds.total = whole.lap();
  return result;
}

std::shared_ptr<const BoundaryStiffness> assemble_stiffness(const TriangleMesh& mesh, double poisson,
                                                            const StiffnessSettings& settings) {
  return assemble(mesh, poisson, settings);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

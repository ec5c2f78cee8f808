#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "softpoint/core/config.h"
#include "softpoint/core/instruction_set.h"
#include "softpoint/core/triangle_mesh.h"

// The elastic solid seen from its surface: a symmetric matrix that takes the displacements of the
// vertices of a closed triangle mesh to the forces that hold them there. Symmetric Galerkin boundary
// elements, derived in doc/boundary_elements.md.
namespace softpoint::inline SOFTPOINT_ABI::elastic {

// The accuracy dial: how the outer of the two surface integrals is done (the inner one is exact).
// Zeros choose by size: below 500 vertices 6 points far and 3 x 6^2 graded points near, else 3 far and
// 12 near. A pair of triangles is near when they share a vertex or their centroids are closer than
// `near_distance` times the longest edge of both.
struct Quadrature {
  int far_points = 0;          // 1, 3, 6 or 12 points a triangle; 0 chooses
  int near_points = 0;         // 3, 6 or 12 points a triangle; 0: graded, or chosen
  int near_graded_order = 0;   // n = 2 to 16: 3 n^2 points graded towards edges and corners; 0: plain
  double near_distance = 1.5;  // 1 to 10

  // Few points, for speed.
  static Quadrature coarse() { return {3, 12, 0, 1.5}; }
  // Many points, for references.
  static Quadrature fine() { return {12, 0, 10, 2.5}; }

  // The same without zeros for a mesh of so many vertices. Throws Error for what is not permitted.
  SOFTPOINT_API Quadrature resolved(int vertices) const;
};

using softpoint::best_instruction_set;
using softpoint::InstructionSet;
using softpoint::name;

// How stiffness is assembled.
struct StiffnessSettings {
  Quadrature quadrature;       // accuracy
  bool keep_traction = false;  // keep V^-1 W too: 3F x 3V doubles and about half as much time again
  InstructionSet max_instruction_set = InstructionSet::kAvx512;  // none beyond it is used
  double memory_limit = 0;  // bytes; 0: what /proc/meminfo calls available
};

// Throws Error naming the field, its value and the permitted range.
SOFTPOINT_API void check(const StiffnessSettings& settings);

// Wall time by stage, s.
struct StiffnessSeconds {
  double quadrature = 0;    // double and single layers of all pairs of triangles
  double assembly = 0;      // V, W and D
  double condensation = 0;  // D + W^T V^-1 W
  double correction = 0;    // affine correction, gravity columns
  double cache = 0;         // reading or writing the cache file
  double total = 0;         // of all
};

// Immutable once made; share it between bodies of one shape and Poisson's ratio. Both Young's modulus
// and density are left out: multiply `unit_stiffness` by Young's modulus (Pa), `gravity_columns` by
// density times the acceleration in the frame of the mesh.
//
// Degrees of freedom are vertex-major: 3 v + {0, 1, 2} for x, y, z of vertex v.
struct BoundaryStiffness {
  TriangleMesh mesh;                                           // as given
  double poisson = 0;                                          // as given
  Quadrature quadrature;                                       // without zeros
  InstructionSet instruction_set = InstructionSet::kBaseline;  // that assembled it

  // S for a Young's modulus of 1 Pa: 3V x 3V, symmetric (bit for bit), m. Nodal forces f = E S u in N,
  // positive when they act on the solid along u. Rigid motions are its null space and affine
  // displacements give their exact forces.
  std::vector<double> unit_stiffness;

  // 3V x 3, column-major, m^3: the load f_b of a body force of 1 N/m^3 along x, y, z of the mesh's
  // frame. Solve E S u = f + gravity_columns b.
  std::vector<double> gravity_columns;

  // V^-1 W for 1 Pa: 3F x 3V, row-major, 1/m, empty unless asked for. Face tractions t = E T u in Pa,
  // constant over each triangle, without body force; rows 3 f + {0, 1, 2}.
  std::vector<double> unit_traction;

  StiffnessSeconds seconds;  // what it took
  bool from_cache = false;   // read from a file, not assembled

  // Degrees of freedom, 3V.
  int dofs() const { return 3 * mesh.vertex_count(); }
};

// Peak of memory taken by assemble_stiffness, result included, in bytes.
SOFTPOINT_API double stiffness_memory(int vertices, int triangles);

// Throws Error for a mesh that bounds no solid, Poisson's ratio or quadrature out of range, or a mesh
// too large for memory (told before anything is allocated).
SOFTPOINT_API std::shared_ptr<const BoundaryStiffness> assemble_stiffness(
    const TriangleMesh& mesh, double poisson, const StiffnessSettings& settings = {});

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

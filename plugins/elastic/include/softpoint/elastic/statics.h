#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "softpoint/core/config.h"
#include "softpoint/core/triangle_mesh.h"
#include "softpoint/core/vec.h"
#include "softpoint/elastic/boundary_stiffness.h"
#include "softpoint/elastic/material.h"

// Linear elastostatics of one body from its surface mesh.
namespace softpoint::inline SOFTPOINT_ABI::elastic {

// The largest traction that a problem may hold, Pa.
inline constexpr double kMaxTraction = 1e15;

// Vertices held at a displacement from their place in the mesh, m; an empty component is free. Up to
// kMaxMeshCoordinate.
struct HeldVertices {
  std::vector<int> vertices;                   // 0-based
  std::array<std::optional<double>, 3> value;  // m, along x, y, z
};

// A uniform traction (force per area, Pa, up to kMaxTraction) on some triangles; several on one triangle add
// up.
struct FaceTraction {
  std::vector<int> faces;     // 0-based
  Vec3 value = Vec3::Zero();  // Pa
};

// All that is neither held nor loaded is free of force.
struct StaticProblem {
  TriangleMesh mesh;                       // metres
  Material material;                       // of the whole solid; its density counts with gravity only
  std::vector<HeldVertices> displacement;  // what is held
  std::vector<FaceTraction> traction;      // what pushes
  Vec3 gravity = Vec3::Zero();             // m/s^2, in the frame of the mesh; up to kMaxAcceleration
};

// Wall time by stage, s.
struct StaticSeconds {
  StiffnessSeconds stiffness;  // its assembly
  double solve = 0;            // displacements
  double traction = 0;         // tractions and energy
  double total = 0;            // of all
};

// What solve_statics finds.
struct StaticResult {
  std::vector<Vec3> displacement;  // one a vertex, m
  // One a vertex, N. At a held component the force of whatever holds it, without the share of tractions
  // given on the faces around it; at a free component the share of those tractions. Gravity's own nodal
  // load is in neither, so that the sum of all nodal forces, the tractions' shares at held components
  // and the weight is zero.
  std::vector<Vec3> nodal_force;
  std::vector<Vec3> traction;  // one a triangle, Pa: V^-1 W (u - u_p) + sigma_p n
  // Strain energy, J: half the volume integral of stress times strain, displacements held included. Not
  // the potential of gravity or of the loads.
  double energy = 0;
  // Rigid motions that nothing held: 0 to 6. The displacement then has no part along them, in the mean
  // over the surface's area.
  int free_rigid_motions = 0;
  StaticSeconds seconds;  // what it took
};

// `stiffness` saves its assembly when given; it must belong to the same mesh and Poisson's ratio and hold
// the traction operator. Throws Error for a mesh, material, index, or number that is not permitted, for a
// component held at two different values, for loads that are not balanced (beyond 1e-6 of their sum)
// along a rigid motion that nothing holds, and for a mesh too large for memory.
SOFTPOINT_API StaticResult solve_statics(const StaticProblem& problem,
                                         std::shared_ptr<const BoundaryStiffness> stiffness = nullptr,
                                         const StiffnessSettings& settings = {});

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

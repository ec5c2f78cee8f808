#pragma once

#include <vector>

#include "softpoint/core/triangle_mesh.h"

// The particular solution for a uniform body force: the field of the hanging bar, equation (17) of
// doc/boundary_elements.md. Young's modulus 1 Pa, coordinates relative to `origin`.
namespace softpoint::inline SOFTPOINT_ABI::elastic {

// A point inside the mesh's bounding box, the origin of all our coordinates: the mean of the vertices.
Vec3 mean_vertex(const TriangleMesh& mesh);

// u_p at x for a body force b (N/m^3), and sigma_p there, three axes superposed.
Vec3 hanging_displacement(const Vec3& x, const Vec3& force, double poisson);
Mat3 hanging_stress(const Vec3& x, const Vec3& force);

// Half the volume integral of sigma_p : epsilon_p.
double hanging_energy(const TriangleMesh& mesh, const Vec3& origin, const Vec3& force, double poisson);

// f_b for a unit body force along x, y and z, column-major 3V x 3, from the full matrix S.
std::vector<double> hanging_loads(const TriangleMesh& mesh, const Vec3& origin, double poisson,
                                  const std::vector<double>& stiffness);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

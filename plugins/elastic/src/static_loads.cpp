#include "static_loads.h"

#include <string>

#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

std::string element(const std::string& list, std::size_t i) { return list + "[" + std::to_string(i) + "]"; }

void hold(const HeldVertices& entry, const std::string& name, int vertex_count, StaticLoads& loads) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (entry.value[k])
      check_range(element(name + ".value", k), *entry.value[k], -kMaxMeshCoordinate, kMaxMeshCoordinate);
  }
  for (std::size_t i = 0; i < entry.vertices.size(); ++i) {
    const int vertex = entry.vertices[i];
    check_index(element(name + ".vertices", i), vertex, vertex_count);
    for (int k = 0; k < 3; ++k) {
      if (!entry.value[k]) continue;
      const Eigen::Index dof = 3 * static_cast<Eigen::Index>(vertex) + k;
      const double value = *entry.value[k];
      if (loads.held[dof] && loads.displacement[dof] != value) {
        throw Error(element(name + ".value", k) + " = " + to_text(value) + ": permitted is " +
                    to_text(loads.displacement[dof]) + ", at which another entry holds vertex " +
                    std::to_string(vertex));
      }
      loads.held[dof] = 1;
      loads.displacement[dof] = value;
    }
  }
}

}  // namespace

StaticLoads gather_loads(const StaticProblem& problem) {
  const TriangleMesh& mesh = problem.mesh;
  const Eigen::Index dofs = 3 * static_cast<Eigen::Index>(mesh.vertex_count());
  StaticLoads loads;
  loads.held.assign(dofs, 0);
  loads.displacement = Eigen::VectorXd::Zero(dofs);
  loads.nodal = Eigen::VectorXd::Zero(dofs);
  for (std::size_t i = 0; i < problem.displacement.size(); ++i) {
    hold(problem.displacement[i], element("displacement", i), mesh.vertex_count(), loads);
  }
  for (std::size_t i = 0; i < problem.traction.size(); ++i) {
    const FaceTraction& entry = problem.traction[i];
    const std::string name = element("traction", i);
    check_range(name + ".value", entry.value, -kMaxTraction, kMaxTraction);
    for (std::size_t j = 0; j < entry.faces.size(); ++j) {
      check_index(element(name + ".faces", j), entry.faces[j], mesh.triangle_count());
      // Consistent nodal loads of a constant traction: a third each.
      const Vec3 share = entry.value * (triangle_area(mesh, entry.faces[j]) / 3.0);
      for (int vertex : mesh.triangles[entry.faces[j]]) loads.nodal.segment<3>(3 * vertex) += share;
    }
  }
  return loads;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

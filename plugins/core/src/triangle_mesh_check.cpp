#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

#include "softpoint/core/error.h"
#include "triangle_mesh_topology.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace mesh_check {
namespace {

struct Shell {
  std::vector<int> triangles;
  Vec3 low, high;  // bounding box
  double volume = 0;
  double area = 0;
};

std::vector<Shell> split(const TriangleMesh& mesh, const Topology& topology) {
  std::vector<Shell> shells(topology.shells);
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    shells[topology.shell_of[t]].triangles.push_back(t);
  }
  for (Shell& shell : shells) {
    const Vec3 origin = mesh.vertices[mesh.triangles[shell.triangles.front()][0]];
    shell.low = shell.high = origin;
    for (const int t : shell.triangles) {
      const auto& [i, j, k] = mesh.triangles[t];
      const Vec3 a = mesh.vertices[i] - origin, b = mesh.vertices[j] - origin, c = mesh.vertices[k] - origin;
      shell.volume += a.dot(b.cross(c)) / 6.0;
      shell.area += triangle_area(mesh, t);
      for (const int v : mesh.triangles[t]) {
        shell.low = shell.low.cwiseMin(mesh.vertices[v]);
        shell.high = shell.high.cwiseMax(mesh.vertices[v]);
      }
    }
  }
  return shells;
}

// Times the shell winds round `x`: +-1 inside, 0 outside, one half on it. Sum of the solid angles
// (van Oosterom and Strackee) over 4 pi.
double winding_number(const TriangleMesh& mesh, const Shell& shell, const Vec3& x) {
  double half_angles = 0.0;
  for (const int t : shell.triangles) {
    const auto& [i, j, k] = mesh.triangles[t];
    const Vec3 a = mesh.vertices[i] - x, b = mesh.vertices[j] - x, c = mesh.vertices[k] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    half_angles +=
        std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return half_angles / (2.0 * std::numbers::pi);
}

// The shell and its triangles, for a message.
std::string shell_text(const Shell& shell, int index) {
  return "shell " + std::to_string(index) + " (" + std::to_string(shell.triangles.size()) +
         " triangles, the first is " + std::to_string(shell.triangles.front()) + ")";
}

bool boxes_nest(const Shell& inner, const Shell& outer) {
  return (inner.low.array() >= outer.low.array()).all() && (inner.high.array() <= outer.high.array()).all();
}

}  // namespace

int check_shells(const TriangleMesh& mesh, const std::string& name, const Topology& topology) {
  const std::vector<Shell> shells = split(mesh, topology);
  int bodies = 0;
  for (int i = 0; i < topology.shells; ++i) {
    const Shell& shell = shells[i];
    // A sphere has V = A^1.5 / 10.6; a shell this much flatter is two sheets on each other.
    if (!(std::abs(shell.volume) > 1e-12 * std::pow(shell.area, 1.5))) {
      throw Error(name + ": " + shell_text(shell, i) + " encloses " + to_text(shell.volume) +
                  " m^3; remove it, or give it thickness");
    }
    const int first = shell.triangles.front();
    const auto& [a, b, c] = mesh.triangles[first];
    const Vec3 probe = (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0;
    int depth = 0, holder = -1;
    for (int j = 0; j < topology.shells; ++j) {
      if (j == i || !boxes_nest(shell, shells[j])) {
        continue;
      }
      const double winding = std::abs(winding_number(mesh, shells[j], probe));
      if (std::abs(winding - std::round(winding)) > 0.25) {
        throw Error(name + ": " + triangle_text(mesh, first) + " of " + shell_text(shell, i) + " touches " +
                    shell_text(shells[j], j) + "; move the two shells apart, or weld them into one");
      }
      if (winding > 0.5) {
        ++depth;
        holder = j;
      }
    }
    const bool is_cavity = depth % 2 == 1;
    if (is_cavity == (shell.volume > 0.0)) {
      throw Error(name + ": " + shell_text(shell, i) +
                  (is_cavity ? " lies inside shell " + std::to_string(holder) +
                                   ", so it bounds a cavity, but faces away from it; flip its " +
                                   std::to_string(shell.triangles.size()) +
                                   " triangles so that they face into the cavity"
                             : " is inside out, it encloses " + to_text(shell.volume) + " m^3; flip its " +
                                   std::to_string(shell.triangles.size()) + " triangles"));
    }
    bodies += is_cavity ? 0 : 1;
  }
  return bodies;
}

}  // namespace mesh_check

MeshReport check_closed(const TriangleMesh& mesh, const std::string& name) {
  mesh_check::check_elements(mesh, name);
  const mesh_check::Topology topology = mesh_check::check_topology(mesh, name, false);
  MeshReport report;
  report.shells = topology.shells;
  report.bodies = mesh_check::check_shells(mesh, name, topology);
  report.volume = signed_volume(mesh);
  report.area = surface_area(mesh);
  if (!(report.volume > 0.0)) {
    throw Error(name + ": encloses " + to_text(report.volume) +
                " m^3 in all: permitted is more than 0; a cavity is larger than what holds it");
  }
  return report;
}

MeshReport check_surface(const TriangleMesh& mesh, const std::string& name) {
  mesh_check::check_elements(mesh, name);
  const mesh_check::Topology topology = mesh_check::check_topology(mesh, name, true);
  MeshReport report;
  report.shells = topology.shells;
  report.boundary_edges = topology.boundary_edges;
  report.area = surface_area(mesh);
  return report;
}

}  // namespace softpoint::inline SOFTPOINT_ABI

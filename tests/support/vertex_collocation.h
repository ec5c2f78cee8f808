#pragma once

#include <Eigen/Dense>

#include "softpoint/core/triangle_mesh.h"
#include "softpoint/elastic/material.h"

#include "elastic/reference_kernels.h"  // continues the namespace that material.h opens

// The plain boundary elements of the elastic-character paper and of ARTDEFO: H u = G t collocated at the
// vertices, displacement and traction both linear over the triangles with one vector a vertex. Slow, obvious,
// and the reason why the library does not use it.
namespace softpoint::elastic::reference {

struct Collocation {
  Eigen::MatrixXd h, g;  // 3V x 3V
};

// Quadrature collapsed (Duffy) towards the corner where the collocation point lies.
inline Collocation collocate(const TriangleMesh& mesh, const Material& material) {
  const double nu = material.poisson, mu = material.young / (2.0 * (1.0 + nu));
  const int n = 3 * mesh.vertex_count();
  Collocation result = {Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  using Both = Eigen::Matrix<double, 3, 18>;  // U phi_a and T phi_a
  for (int i = 0; i < mesh.vertex_count(); ++i) {
    const Vec3 x = mesh.vertices[i];
    for (const Triangle& triangle : mesh.triangles) {
      // Rotated so that a corner at x comes first.
      int first = 0;
      for (int a = 0; a < 3; ++a) first = triangle[a] == i ? a : first;
      const bool touches = triangle[first] == i;
      Corners v;
      for (int a = 0; a < 3; ++a) v[a] = mesh.vertices[triangle[(first + a) % 3]];
      const Vec3 face_normal = normal(v);
      const auto integrand = [&](const Vec3& y, const Vec3& phi) {
        const Mat3 u = kelvin_displacement(x, y, mu, nu);
        const Mat3 t = kelvin_traction(x, y, face_normal, nu);
        Both value;
        for (int a = 0; a < 3; ++a) {
          value.block<3, 3>(0, 3 * a) = phi[a] * u;
          value.block<3, 3>(0, 9 + 3 * a) = phi[a] * t;
        }
        return value;
      };
      Both integral = integrate_collapsed<Both>(v, kUnitShapes, integrand);
      // T phi_0 is strongly singular there; it goes into the diagonal, by rigid translation below.
      if (touches) integral.middleCols<3>(9).setZero();
      for (int a = 0; a < 3; ++a) {
        const int column = 3 * triangle[(first + a) % 3];
        result.g.block<3, 3>(3 * i, column) += integral.block<3, 3>(0, 3 * a);
        result.h.block<3, 3>(3 * i, column) += integral.block<3, 3>(0, 9 + 3 * a);
      }
    }
    Mat3 sum = Mat3::Zero();
    for (int j = 0; j < mesh.vertex_count(); ++j) sum += result.h.block<3, 3>(3 * i, 3 * j);
    result.h.block<3, 3>(3 * i, 3 * i) -= sum;
  }
  return result;
}

// X = -A^-1 H u of the paper's equation (2), for vertices whose displacement is known (`held`) and all others
// free of traction: rows 3 v + {0, 1, 2} are the traction where held, the displacement where free; columns as
// in `held`.
inline Eigen::MatrixXd collocation_response(const Collocation& c, const std::vector<int>& held) {
  Eigen::MatrixXd unknown = c.h, known(c.h.rows(), 3 * static_cast<Eigen::Index>(held.size()));
  for (std::size_t i = 0; i < held.size(); ++i) {
    unknown.middleCols<3>(3 * held[i]) = -c.g.middleCols<3>(3 * held[i]);
    known.middleCols<3>(3 * static_cast<Eigen::Index>(i)) = -c.h.middleCols<3>(3 * held[i]);
  }
  return unknown.partialPivLu().solve(known);
}

}  // namespace softpoint::elastic::reference

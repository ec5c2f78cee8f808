// The closed-form integrals over a triangle against brute-force quadrature, for every instruction set, and
// laws of the Galerkin matrices that hold before any correction.
#include <gtest/gtest.h>

#include "elastic_support.h"
#include "galerkin.h"
#include "instruction_set.h"
#include "kernels.h"
#include "panels.h"
#include "reference_kernels.h"

namespace softpoint::elastic {
namespace {

using reference::Corners;
using Integrals = Eigen::Matrix<double, kPanelIntegrals, 1>;

Integrals closed_form(const Corners& v, const Vec3& x, const Kernels& kernels) {
  TriangleMesh mesh;
  mesh.vertices.assign(v.begin(), v.end());
  mesh.triangles = {{0, 1, 2}};
  const Panels panels(mesh, Vec3::Zero());
  const double point[4] = {x.x(), x.y(), x.z(), 1.0};
  std::vector<double> out(kPanelIntegrals * kernels.lanes);
  kernels.layer_potentials(panels.fields(), panels.stride(), point, 1, out.data());
  Integrals result;
  for (int k = 0; k < kPanelIntegrals; ++k) {
    result[k] = out[k * kernels.lanes];
    // The other lanes hold the same triangle.
    for (int i = 1; i < kernels.lanes; ++i) EXPECT_EQ(out[k * kernels.lanes + i], result[k]);
  }
  return result;
}

Integrals brute_force(const Corners& v, const Vec3& x, bool inside = false) {
  const Vec3 n = reference::normal(v);
  const auto integrand = [&](const Vec3& y, const Vec3& phi) {
    const Vec3 r = y - x;
    const double distance = r.norm(), cube = distance * distance * distance;
    Integrals value;
    value[kSingle] = 1.0 / distance;
    const double tensor[6] = {r.x() * r.x(), r.y() * r.y(), r.z() * r.z(),
                              r.x() * r.y(), r.x() * r.z(), r.y() * r.z()};
    for (int k = 0; k < 6; ++k) value[kTensor + k] = tensor[k] / cube;
    for (int a = 0; a < 3; ++a) value[kDouble + a] = -r.dot(n) / cube * phi[a];
    return value;
  };
  if (inside) return reference::integrate_around<Integrals>(v, x, integrand);
  return reference::integrate_near<Integrals>(v, reference::kUnitShapes, x, integrand);
}

std::vector<const Kernels*> available_kernels() {
  std::vector<const Kernels*> result;
  for (InstructionSet set : {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    if (choose_instruction_set(set) == set) result.push_back(&kernels_for(set));
  }
  return result;
}

TEST(PanelIntegrals, MatchBruteForce) {
  const std::vector<Corners> triangles = {
      {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
      {Vec3(0.2, -0.1, 0.4), Vec3(1.1, 0.3, -0.2), Vec3(0.1, 0.9, 0.7)},
      {Vec3(0, 0, 0), Vec3(2, 0.1, 0.3), Vec3(1.9, 0.3, 0.2)},  // a sliver
  };
  double worst = 0.0;
  for (const Corners& v : triangles) {
    const Vec3 n = reference::normal(v), centre = (v[0] + v[1] + v[2]) / 3.0;
    Noise noise;
    std::vector<Vec3> points = {centre + 0.3 * n, centre - 1e-3 * n, centre + 5.0 * n};
    points.push_back(centre + (v[1] - v[0]) * 1.7);          // in the plane, beside
    points.push_back(v[0] + (v[0] - v[1]) * 0.5 + 0.1 * n);  // near an edge's extension
    points.push_back(0.5 * (v[1] + v[2]) + 0.02 * n.cross(v[2] - v[1]) * -1 + 0.01 * n);  // just off an edge
    for (int i = 0; i < 6; ++i) points.push_back(centre + 1.5 * Vec3(noise(), noise(), noise()));
    for (const Vec3& x : points) {
      const Integrals exact = brute_force(v, x);
      for (const Kernels* kernels : available_kernels()) {
        const Integrals value = closed_form(v, x, *kernels);
        const double error = (value - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
        worst = std::max(worst, error);
        EXPECT_LE(error, 2e-12) << "x " << x.transpose() << "\nclosed " << value.transpose() << "\nbrute  "
                                << exact.transpose();
      }
    }
  }
  std::printf("closed forms against brute force: worst relative error %.1e\n", worst);
}

// On the triangle itself the double layer is left to the caller; 1/R and r r^T / R^3 must hold.
TEST(PanelIntegrals, MatchBruteForceOnTheirOwnTriangle) {
  const Corners v = {Vec3(0.2, -0.1, 0.4), Vec3(1.1, 0.3, -0.2), Vec3(0.1, 0.9, 0.7)};
  for (const RulePoint& p : graded_rule(3)) {
    const Vec3 x = p.a * v[0] + p.b * v[1] + (1.0 - p.a - p.b) * v[2];
    const Integrals exact = brute_force(v, x, true);
    for (const Kernels* kernels : available_kernels()) {
      EXPECT_LE((closed_form(v, x, *kernels) - exact).head<kDouble>().norm(),
                1e-10 * exact.head<kDouble>().norm());
    }
  }
}

// Sum over a closed surface of the solid angles: 4 pi inside, none outside.
TEST(PanelIntegrals, SolidAnglesOfAClosedSurfaceAddUp) {
  const TriangleMesh mesh = irregular_solid();
  const Panels panels(mesh, Vec3::Zero());
  for (const Kernels* kernels : available_kernels()) {
    const Vec3 inside = mesh.vertices[0] * 0.3 + mesh.vertices.back() * 0.7;
    for (const auto& [x, angle] : {std::pair(inside, 4.0), std::pair(Vec3(3, 1, 2), 0.0)}) {
      const double point[4] = {x.x(), x.y(), x.z(), 1.0};
      double sum = 0.0;
      std::vector<double> out(kPanelIntegrals * kernels->lanes);
      for (int f = 0; f < panels.count(); ++f) {
        kernels->layer_potentials(panels.fields() + f, panels.stride(), point, 1, out.data());
        for (int a = 0; a < 3; ++a) sum += out[(kDouble + a) * kernels->lanes];
      }
      EXPECT_NEAR(sum, -angle * std::numbers::pi, 1e-12);
    }
  }
}

// The regularised operators of two triangles far apart against the kernels of the textbook: V_fg, and
// W_fg = - int int T phi_a (the free term is absent).
TEST(GalerkinMatrices, MatchTheTextbookKernelsOnAClosedSurface) {
  const double nu = 0.3, mu = 0.5 / 1.3;
  const TriangleMesh mesh = box_grid(3, 3, 3, Vec3(1, 1, 1));
  const Panels panels(mesh, Vec3::Zero());
  GalerkinMatrices m;
  const Quadrature quadrature = {12, 0, 10, 1.5};
  integrate_layers(panels, mesh.vertex_count(), nu, quadrature, *kernels_baseline(), m);
  assemble_regularised(panels, mesh.vertex_count(), nu, m);
  const Eigen::Map<const Matrix> v(m.v.data(), 3 * panels.count(), 3 * panels.count());
  const Eigen::Map<const Matrix> wt(m.w_transposed.data(), 3 * mesh.vertex_count(), 3 * panels.count());

  const auto corners = [&](int f) {
    const Triangle& t = mesh.triangles[f];
    return Corners{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
  };
  const int f = 0;
  int far = 0;
  for (int g = 0; g < panels.count(); ++g) {
    if (panels.near(f, g, quadrature.near_distance)) continue;
    ++far;
    const Mat3 exact = reference::integrate_collapsed<Mat3>(
        corners(f), reference::kUnitShapes, [&](const Vec3& x, const Vec3&) {
          return reference::integrate_collapsed<Mat3>(
              corners(g), reference::kUnitShapes,
              [&](const Vec3& y, const Vec3&) { return reference::kelvin_displacement(x, y, mu, nu); });
        });
    EXPECT_LE((v.block<3, 3>(3 * f, 3 * g) - exact).norm(), 1e-6 * exact.norm());
  }
  EXPECT_GT(far, 0);

  // A whole row of W on a vertex whose triangles are all away from f, so that T is regular there. The
  // regularisation moves derivatives between triangles and is equal only in sum.
  int vertices = 0;
  for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    bool away = true;
    Mat3 exact = Mat3::Zero();
    for (int g = 0; g < panels.count(); ++g) {
      for (int a = 0; a < 3; ++a) {
        if (mesh.triangles[g][a] != vertex) continue;
        away = away && !panels.near(f, g, 1.2);
        const Vec3 n = panels.normal(g);
        exact += reference::integrate_collapsed<Mat3>(
            corners(f), reference::kUnitShapes, [&](const Vec3& x, const Vec3&) {
              return reference::integrate_collapsed<Mat3>(
                  corners(g), reference::kUnitShapes, [&](const Vec3& y, const Vec3& phi) {
                    return Mat3(phi[a] * reference::kelvin_traction(x, y, n, nu));
                  });
            });
      }
    }
    if (!away) continue;
    ++vertices;
    const Mat3 value = wt.block<3, 3>(3 * vertex, 3 * f).transpose();
    EXPECT_LE((value - exact).norm(), 1e-6 * exact.norm()) << value << "\n\n" << exact;
  }
  EXPECT_GT(vertices, 0);
}

TEST(GalerkinMatrices, RigidMotionsHaveNoTractionBeforeAnyCorrection) {
  const TriangleMesh mesh = irregular_solid();
  const Panels panels(mesh, Vec3::Zero());
  GalerkinMatrices m;
  integrate_layers(panels, mesh.vertex_count(), 0.3, Quadrature{}.resolved(mesh.vertex_count()),
                   *kernels_baseline(), m);
  assemble_regularised(panels, mesh.vertex_count(), 0.3, m);
  const Eigen::Map<const Matrix> wt(m.w_transposed.data(), 3 * mesh.vertex_count(), 3 * panels.count());
  const Eigen::Map<const Matrix> d(m.d.data(), 3 * mesh.vertex_count(), 3 * mesh.vertex_count());
  const Matrix rigid = rigid_motions(mesh);
  const Matrix w_rigid = wt.transpose() * rigid, d_rigid = d * rigid;
  EXPECT_LE(w_rigid.leftCols(3).cwiseAbs().maxCoeff(), 1e-4 * wt.cwiseAbs().maxCoeff());
  EXPECT_LE(d_rigid.leftCols(3).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LE(w_rigid.rightCols(3).cwiseAbs().maxCoeff(), 1e-3 * wt.cwiseAbs().maxCoeff());
  EXPECT_LE(d_rigid.rightCols(3).cwiseAbs().maxCoeff(), 1e-3 * d.cwiseAbs().maxCoeff());
}

TEST(Rules, IntegratePolynomials) {
  // int over the triangle of a^i b^j c^k, divided by its area: 2 i! j! k! / (i + j + k + 2)!
  const auto exact = [](int i, int j, int k) {
    return 2.0 * std::tgamma(i + 1) * std::tgamma(j + 1) * std::tgamma(k + 1) / std::tgamma(i + j + k + 3);
  };
  const auto check_rule = [&](const Rule& rule, int degree, double gate) {
    for (int i = 0; i <= degree; ++i) {
      for (int j = 0; i + j <= degree; ++j) {
        double sum = 0.0;
        for (const RulePoint& p : rule) sum += p.weight * std::pow(p.a, i) * std::pow(p.b, j);
        EXPECT_NEAR(sum, exact(i, j, 0), gate) << rule.size() << " points, a^" << i << " b^" << j;
      }
    }
  };
  check_rule(symmetric_rule(1), 1, 1e-14);
  check_rule(symmetric_rule(3), 2, 1e-14);
  check_rule(symmetric_rule(6), 4, 1e-14);
  check_rule(symmetric_rule(12), 6, 1e-14);
  check_rule(graded_rule(6), 0, 1e-14);
  check_rule(graded_rule(12), 2, 1e-10);
}

}  // namespace
}  // namespace softpoint::elastic

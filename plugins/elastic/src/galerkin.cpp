#include "galerkin.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cstddef>
#include <numbers>

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

constexpr double kPi = std::numbers::pi;

double shear_modulus(double poisson) { return 0.5 / (1.0 + poisson); }

// Turns the kernel's integrals over pairs (f, g) into entries of the matrices.
struct PairWriter {
  GalerkinMatrices& to;
  const Panels& panels;
  std::size_t rows_v, rows_w;
  double scale, isotropic;  // C_U, 3 - 4 nu, equation (1)

  void write(int f, int g, const double* integral, int lanes) const {
    const auto at = [=](int k) { return integral[k * lanes]; };
    to.single[static_cast<std::size_t>(f) * panels.count() + g] = at(kSingle) / (4.0 * kPi);
    static constexpr int kSymmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (int j = 0; j < 3; ++j) {
      double* column =
          &to.v[(3 * static_cast<std::size_t>(f) + j) * rows_v + 3 * static_cast<std::size_t>(g)];
      for (int i = 0; i < 3; ++i) {
        column[i] = scale * (at(kTensor + kSymmetric[i][j]) + (i == j ? isotropic * at(kSingle) : 0.0));
      }
    }
  }

  // The double layer adds up over the panels g round a vertex.
  void add_double_layer(int f, int g, const double* integral, int lanes) const {
    for (int a = 0; a < 3; ++a) {
      add_to_diagonal(f, panels.vertices(g)[a], integral[(kDouble + a) * lanes] / (4.0 * kPi));
    }
  }

  void add_to_diagonal(int f, int vertex, double value) const {
    for (std::size_t k = 0; k < 3; ++k) {
      to.w_transposed[(3 * static_cast<std::size_t>(f) + k) * rows_w + 3 * static_cast<std::size_t>(vertex) +
                      k] += value;
    }
  }
};

void symmetrise(std::vector<double>& matrix, std::size_t n) {
  constexpr std::size_t kTile = 32;
  for (std::size_t j0 = 0; j0 < n; j0 += kTile) {
    for (std::size_t i0 = j0; i0 < n; i0 += kTile) {
      for (std::size_t j = j0; j < std::min(n, j0 + kTile); ++j) {
        for (std::size_t i = std::max(i0, j + 1); i < std::min(n, i0 + kTile); ++i) {
          double& lower = matrix[i + j * n];
          double& upper = matrix[j + i * n];
          lower = upper = 0.5 * (lower + upper);
        }
      }
    }
  }
}

}  // namespace

void integrate_layers(const Panels& panels, int vertices, double poisson, const Quadrature& quadrature,
                      const Kernels& kernels, GalerkinMatrices& matrices) {
  const std::size_t faces = panels.count(), rows_w = 3 * static_cast<std::size_t>(vertices);
  matrices.v.assign(9 * faces * faces, 0.0);
  matrices.single.assign(faces * faces, 0.0);
  matrices.w_transposed.assign(3 * faces * rows_w, 0.0);
  const PairWriter writer = {matrices,
                             panels,
                             3 * faces,
                             rows_w,
                             1.0 / (16.0 * kPi * shear_modulus(poisson) * (1.0 - poisson)),
                             3.0 - 4.0 * poisson};
  const Rule far = far_rule(quadrature), near = near_rule(quadrature);
  const int count = panels.count(), lanes = kernels.lanes;
  std::vector<double> far_points, near_points;
  std::vector<double> gathered(kPanelFields * lanes), integrals(kPanelIntegrals * lanes);
  std::vector<int> neighbours;
  std::vector<char> is_near(faces);

  for (int f = 0; f < count; ++f) {
    panels.place(far, f, far_points);
    panels.place(near, f, near_points);
    neighbours.clear();
    for (int g = 0; g < count; ++g) {
      is_near[g] = panels.near(f, g, quadrature.near_distance);
      if (is_near[g]) neighbours.push_back(g);
    }
    // All others in packs as they come; near ones among them are computed in vain, which costs less than
    // gathering.
    for (int first = 0; first < count; first += lanes) {
      const int used = std::min(lanes, count - first);
      if (std::all_of(&is_near[first], &is_near[first] + used, [](char n) { return n; })) continue;
      kernels.layer_potentials(panels.fields() + first, panels.stride(), far_points.data(),
                               static_cast<int>(far.size()), integrals.data());
      for (int i = 0; i < used; ++i) {
        if (is_near[first + i]) continue;
        writer.write(f, first + i, &integrals[i], lanes);
        writer.add_double_layer(f, first + i, &integrals[i], lanes);
      }
    }
    const int near_count = static_cast<int>(neighbours.size());
    for (int first = 0; first < near_count; first += lanes) {
      for (int i = 0; i < lanes; ++i) {
        const int g = neighbours[std::min(first + i, near_count - 1)];
        for (int k = 0; k < kPanelFields; ++k)
          gathered[k * lanes + i] = panels.fields()[k * panels.stride() + g];
      }
      kernels.layer_potentials(gathered.data(), lanes, near_points.data(), static_cast<int>(near.size()),
                               integrals.data());
      for (int i = 0; i < std::min(lanes, near_count - first); ++i) {
        const int g = neighbours[first + i];
        writer.write(f, g, &integrals[i], lanes);
        // A flat panel has no double layer on itself; rounding of h would make it +-2 pi.
        if (g != f) writer.add_double_layer(f, g, &integrals[i], lanes);
      }
    }
    for (int vertex : panels.vertices(f)) writer.add_to_diagonal(f, vertex, panels.area(f) / 6.0);
  }
}

// Equations (11) and (12). With M_a = [c_a]_x, per panel f and vertex a:
//   q_a = sum_g SL_fg c_a^g,   N_a = 2 mu sum_g V_fg [c_a^g]_x - [q_a]_x,
//   W_fa += N_a,   D_ba += mu [2 (c_b.q_a) 1 - c_b q_a^T] + 2 mu [c_b]_x N_a.
void assemble_regularised(const Panels& panels, int vertices, double poisson, GalerkinMatrices& matrices) {
  const std::size_t faces = panels.count(), columns = 3 * static_cast<std::size_t>(vertices);
  const double mu = shear_modulus(poisson);
  symmetrise(matrices.v, 3 * faces);
  symmetrise(matrices.single, faces);
  matrices.d.assign(columns * columns, 0.0);
  std::vector<double> q(columns), n[3];
  for (auto& row : n) row.resize(columns);

  for (std::size_t f = 0; f < faces; ++f) {
    std::fill(q.begin(), q.end(), 0.0);
    for (auto& row : n) std::fill(row.begin(), row.end(), 0.0);
    const double* const single = &matrices.single[f * faces];
    for (std::size_t g = 0; g < faces; ++g) {
      double row[3][3];  // row k of 2 mu V_fg - SL_fg 1
      for (std::size_t k = 0; k < 3; ++k) {
        const double* v = &matrices.v[(3 * f + k) * 3 * faces + 3 * g];
        for (int j = 0; j < 3; ++j) row[k][j] = 2.0 * mu * v[j];
        row[k][k] -= single[g];
      }
      for (int a = 0; a < 3; ++a) {
        const Vec3& c = panels.curl(static_cast<int>(g), a);
        const std::size_t at = 3 * static_cast<std::size_t>(panels.vertices(static_cast<int>(g))[a]);
        for (int j = 0; j < 3; ++j) q[at + j] += single[g] * c[j];
        for (int k = 0; k < 3; ++k) {
          n[k][at] += row[k][1] * c[2] - row[k][2] * c[1];
          n[k][at + 1] += row[k][2] * c[0] - row[k][0] * c[2];
          n[k][at + 2] += row[k][0] * c[1] - row[k][1] * c[0];
        }
      }
    }
    for (std::size_t k = 0; k < 3; ++k) {
      double* w = &matrices.w_transposed[(3 * f + k) * columns];
      for (std::size_t i = 0; i < columns; ++i) w[i] += n[k][i];
    }
    for (int b = 0; b < 3; ++b) {
      const Vec3 c = panels.curl(static_cast<int>(f), b) * mu;
      double* d[3];  // D is symmetric: row 3 b + i is column 3 b + i
      for (std::size_t i = 0; i < 3; ++i) {
        d[i] = &matrices
                    .d[(3 * static_cast<std::size_t>(panels.vertices(static_cast<int>(f))[b]) + i) * columns];
      }
      for (std::size_t a = 0; a < columns; a += 3) {
        const double cq = 2.0 * (c[0] * q[a] + c[1] * q[a + 1] + c[2] * q[a + 2]);
        for (std::size_t j = 0; j < 3; ++j) {
          const double x = 2.0 * n[0][a + j], y = 2.0 * n[1][a + j], z = 2.0 * n[2][a + j];
          d[0][a + j] += c[1] * z - c[2] * y - c[0] * q[a + j];
          d[1][a + j] += c[2] * x - c[0] * z - c[1] * q[a + j];
          d[2][a + j] += c[0] * y - c[1] * x - c[2] * q[a + j];
          d[j][a + j] += cq;
        }
      }
    }
  }
  symmetrise(matrices.d, columns);
  std::vector<double>().swap(matrices.single);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

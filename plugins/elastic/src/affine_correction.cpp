#include "affine_correction.h"

#include <Eigen/QR>

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

using Matrix = Eigen::MatrixXd;
constexpr int kFields = 12;

// The displacements u = H (1, x / size), one a column: translations, then H_ij at 3 + 3 i + j.
Matrix affine_fields(const std::vector<Vec3>& points, double size) {
  Matrix p = Matrix::Zero(3 * static_cast<Eigen::Index>(points.size()), kFields);
  for (std::size_t v = 0; v < points.size(); ++v) {
    for (int i = 0; i < 3; ++i) {
      const auto row = 3 * static_cast<Eigen::Index>(v) + i;
      p(row, i) = 1.0;
      for (int j = 0; j < 3; ++j) p(row, 3 + 3 * i + j) = points[v][j] / size;
    }
  }
  return p;
}

// Their exact nodal forces B^T (sigma n).
Matrix affine_forces(const Panels& panels, Eigen::Index rows, double size, double poisson) {
  const double mu = 0.5 / (1.0 + poisson);
  const double lambda = poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
  Matrix force = Matrix::Zero(rows, kFields);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      Mat3 gradient = Mat3::Zero();
      gradient(i, j) = 1.0 / size;
      const Mat3 sigma =
          lambda * gradient.trace() * Mat3::Identity() + mu * (gradient + gradient.transpose());
      for (int f = 0; f < panels.count(); ++f) {
        const Vec3 share = sigma * panels.normal(f) * (panels.area(f) / 3.0);
        for (int vertex : panels.vertices(f)) force.block<3, 1>(3 * vertex, 3 + 3 * i + j) += share;
      }
    }
  }
  return force;
}

}  // namespace

void correct_affine(const Panels& panels, const std::vector<Vec3>& points, double poisson,
                    std::vector<double>& stiffness) {
  const Eigen::Index n = 3 * static_cast<Eigen::Index>(points.size());
  Eigen::Map<Matrix> s(stiffness.data(), n, n);
  double size = 0.0;
  for (const Vec3& x : points) size = std::max(size, x.norm());

  const Eigen::HouseholderQR<Matrix> qr(affine_fields(points, size));
  const Matrix q = qr.householderQ() * Matrix::Identity(n, kFields);
  Matrix e = affine_forces(panels, n, size, poisson);
  qr.matrixQR().topRows(kFields).triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(e);
  e -= s.selfadjointView<Eigen::Lower>() * q;

  // E Q^T + Q E^T - Q (Q^T E) Q^T = E' Q^T + Q E'^T with E' = E - Q (Q^T E) / 2.
  const Matrix g = q.transpose() * e;
  e -= q * (0.25 * (g + g.transpose()));
  const Matrix qt = q.transpose(), et = e.transpose();
  for (Eigen::Index j = 0; j < n; ++j) {
    const Eigen::Index rest = n - j;
    s.col(j).tail(rest).noalias() += e.bottomRows(rest) * qt.col(j) + q.bottomRows(rest) * et.col(j);
    s.row(j).tail(rest - 1) = s.col(j).tail(rest - 1).transpose();
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#include "rigid_modes.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

// Holders whose lever arms are below this fraction of the body's size do not count as holding a rotation.
constexpr double kRankTolerance = 1e-7;

}  // namespace

FreeRigidModes::FreeRigidModes(const TriangleMesh& mesh, const Vec3& centre, const std::vector<char>& held) {
  const Eigen::Index n = 3 * static_cast<Eigen::Index>(mesh.vertex_count());
  for (const Vec3& x : mesh.vertices) size_ = std::max(size_, (x - centre).norm());
  motions_.resize(n, 6);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 arm = (mesh.vertices[v] - centre) / size_;
    for (int k = 0; k < 3; ++k) {
      motions_.block<3, 1>(3 * v, k) = Vec3::Unit(k);
      motions_.block<3, 1>(3 * v, 3 + k) = Vec3::Unit(k).cross(arm);
    }
  }
  // Free is what does not move any held component: the null space of the held rows.
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (held[i]) rows.push_back(i);
  }
  free_ = Eigen::MatrixXd::Identity(6, 6);
  if (!rows.empty()) {
    const Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::FullPivHouseholderQRPreconditioner> svd(
        motions_(rows, Eigen::all).eval(), Eigen::ComputeFullV);
    const auto& values = svd.singularValues();
    const Eigen::Index rank = (values.array() > kRankTolerance).count();
    free_ = svd.matrixV().rightCols(6 - rank);
  }
  modes_ = motions_ * free_;
  if (count() > 0) {
    for (Eigen::Index row : rows) modes_.row(row).setZero();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(modes_);
    modes_ = qr.householderQ() * Eigen::MatrixXd::Identity(n, count());
  }
}

FreeRigidModes::Wrench FreeRigidModes::resultant(const Eigen::VectorXd& load) const {
  Wrench wrench = {Vec3::Zero(), Vec3::Zero(), 0.0};
  if (count() == 0) return wrench;
  const Eigen::VectorXd along = free_ * (free_.transpose() * (motions_.transpose() * load));
  double scale = 0.0;
  for (Eigen::Index v = 0; v < load.size() / 3; ++v) scale += load.segment<3>(3 * v).norm();
  wrench.force = along.head<3>();
  wrench.moment = along.tail<3>() * size_;
  if (scale > 0.0) wrench.relative = along.norm() / scale;
  return wrench;
}

void FreeRigidModes::remove_from(Eigen::VectorXd& displacement, const std::vector<double>& weight) const {
  if (count() == 0) return;
  Eigen::MatrixXd weighted = modes_;
  for (std::size_t v = 0; v < weight.size(); ++v) {
    weighted.middleRows<3>(3 * static_cast<Eigen::Index>(v)) *= weight[v];
  }
  const Eigen::MatrixXd gram = modes_.transpose() * weighted;
  displacement -= modes_ * gram.llt().solve(weighted.transpose() * displacement);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

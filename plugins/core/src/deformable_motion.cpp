// Motion of a deformable as one body: centre of mass, momentum, energy, and couples that act on all of it.
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "softpoint/core/deformable.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Of the largest moment of inertia: points in a line do not turn about it.
constexpr double kLeastInertia = 1e-12;

}  // namespace

Vec3 Deformable::center_of_mass() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    sum += masses_[v] * positions_[v];
  }
  return sum / total_mass_;
}

Vec3 Deformable::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    sum += masses_[v] * velocities_[v];
  }
  return sum;
}

Vec3 Deformable::angular_momentum(const Vec3& about) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    sum += masses_[v] * (positions_[v] - about).cross(velocities_[v]);
  }
  return sum;
}

double Deformable::kinetic_energy() const {
  double sum = 0;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    sum += 0.5 * masses_[v] * velocities_[v].squaredNorm();
  }
  return sum;
}

// As a rigid body: velocities change, positions are final. About an axis without inertia nothing turns.
void Deformable::turn_by_couple() {
  if (couple_.isZero(0)) {
    return;
  }
  const Vec3 center = center_of_mass();
  Mat3 inertia = Mat3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    const Vec3 arm = positions_[v] - center;
    inertia += masses_[v] * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(inertia);
  const Vec3 about = axes.eigenvectors().transpose() * couple_;
  Vec3 turn = Vec3::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (axes.eigenvalues()[i] > kLeastInertia * axes.eigenvalues()[2]) {
      turn += about[i] / axes.eigenvalues()[i] * axes.eigenvectors().col(i);
    }
  }
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    velocities_[v] += turn.cross(positions_[v] - center);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI

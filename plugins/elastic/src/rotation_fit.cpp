#include "rotation_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

Mat3 symmetric_part(const Mat3& a) { return 0.5 * (a + a.transpose()); }
Mat3 trace_minus(const Mat3& s) { return s.trace() * Mat3::Identity() - s; }

// inverse = (tr(S) 1 - S)^-1, S the symmetric part of b; false where that is not positive, which leaves
// `inverse` as it was.
bool invert_form(const Mat3& b, double least, Mat3& inverse) {
  const double xx = b(1, 1) + b(2, 2), yy = b(2, 2) + b(0, 0), zz = b(0, 0) + b(1, 1);
  const double xy = -0.5 * (b(0, 1) + b(1, 0)), yz = -0.5 * (b(1, 2) + b(2, 1)),
               zx = -0.5 * (b(2, 0) + b(0, 2));
  const double cxx = yy * zz - yz * yz, cxy = yz * zx - xy * zz, czx = xy * yz - yy * zx;
  const double cyy = zz * xx - zx * zx, cyz = zx * xy - yz * xx, czz = xx * yy - xy * xy;
  const double det = xx * cxx + xy * cxy + zx * czx;
  if (!(xx > least && czz > least * least && det > least * least * least)) return false;
  const double d = 1.0 / det;
  inverse << d * cxx, d * cxy, d * czx, d * cxy, d * cyy, d * cyz, d * czx, d * cyz, d * czz;
  return true;
}

}  // namespace

Mat3 turn_by(const Vec3& rotation_vector) {
  const double angle = rotation_vector.norm();
  return angle > 1e-300 ? Mat3(Eigen::AngleAxisd(angle, rotation_vector / angle)) : Mat3(Mat3::Identity());
}

Mat3 turn_between(const Vec3& from, const Vec3& to) {
  if (from.norm() < 1e-12 || to.norm() < 1e-12) return Mat3::Identity();
  return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

Mat3 nearest_rotation(const Mat3& a) {
  const Eigen::JacobiSVD<Mat3> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double mirror = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * Vec3(1, 1, mirror).asDiagonal() * svd.matrixV().transpose();
}

void fit_rotation(const Mat3& a, Mat3& r, Mat3& inverse) {
  const double scale = a.norm();
  constexpr double kFlat = 1e-6;  // of the scale: below, the fit turns too easily to be of use
  for (int i = 0; i < 8; ++i) {
    const Mat3 b = r.transpose() * a;
    const Vec3 skew(b(2, 1) - b(1, 2), b(0, 2) - b(2, 0), b(1, 0) - b(0, 1));
    if (!invert_form(b, kFlat * scale, inverse)) break;
    const Vec3 turn = inverse * skew;
    const double size = turn.norm();
    if (size < 1e-15) return;
    if (size > 0.5) break;
    const double half = 0.5 * size;
    // A unit quaternion by its vector part: no trigonometry for small turns.
    const Vec3 v = size < 1e-4 ? Vec3(0.5 * turn) : Vec3(std::sin(half) / size * turn);
    r = r * Eigen::Quaterniond(std::sqrt(1.0 - v.squaredNorm()), v.x(), v.y(), v.z()).toRotationMatrix();
    if (size < 1e-8) return;  // the next turn would be of the order of its square
  }
  if (!(scale > 0.0)) {
    inverse.setZero();
    return;
  }
  r = nearest_rotation(a);
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(trace_minus(symmetric_part(r.transpose() * a)));
  Vec3 values = eigen.eigenvalues();
  for (double& value : values) value = value > kFlat * scale ? 1.0 / value : 0.0;
  inverse = eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#include "segment_tangent.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

constexpr Eigen::Index kSums = 15;

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

SegmentTangent::SegmentTangent(const PackedModel& packed, bool single) {
  const SegmentModel& model = *packed.model;
  const Eigen::Index count = model.joint_points();
  interfaces_ = static_cast<Eigen::Index>(model.interfaces.size());
  modes_.setZero(3 * count, 6 * interfaces_);
  Eigen::MatrixXd of_forces = Eigen::MatrixXd::Zero(3 * count, kSums * interfaces_);
  Eigen::MatrixXd of_places = of_forces;
  Mat3 moment = packed.arms.transpose() * packed.arms;
  frame_.setZero(3, 6 * interfaces_);
  Eigen::Index first = 0;
  for (Eigen::Index i = 0; i < interfaces_; ++i) {
    const auto n = static_cast<Eigen::Index>(model.interfaces[static_cast<std::size_t>(i)].size());
    const Vec3 center = packed.arms.middleRows(first, n).colwise().mean();
    centers_.push_back(center);
    for (Eigen::Index k = first; k < first + n; ++k) {
      const Vec3 arm = packed.arms.row(k).transpose() - center;
      for (Eigen::Index a = 0; a < 3; ++a) {
        modes_(a * count + k, 6 * i + a) = 1.0;
        const Vec3 turned = Vec3::Unit(a).cross(arm);
        for (Eigen::Index b = 0; b < 3; ++b) modes_(b * count + k, 6 * i + 3 + a) = turned[b];
        of_forces(a * count + k, kSums * i + a) = 1.0;
        // Entry (a, b) of the sum of arm force^T.
        for (Eigen::Index b = 0; b < 3; ++b) of_forces(b * count + k, kSums * i + 3 + 3 * b + a) = arm[a];
        of_places(a * count + k, kSums * i + 12 + a) = 1.0 / static_cast<double>(n);
      }
    }
    first += n;
  }
  const Mat3 form = moment.trace() * Mat3::Identity() - moment;
  for (Eigen::Index k = 0; k < count; ++k) {
    Eigen::Matrix3Xd moved(3, 6 * interfaces_);
    for (Eigen::Index a = 0; a < 3; ++a) moved.row(a) = modes_.row(a * count + k);
    frame_ += cross_matrix(packed.arms.row(k).transpose()) * moved;
  }
  frame_ = form.inverse() * frame_;
  const Eigen::Map<const Eigen::MatrixXd> k(model.stiffness.data(), 3 * count, 3 * count);
  rest_ = modes_.transpose() * k * modes_;
  sums_ = Product(*packed.kernels, of_forces.transpose() * k + of_places.transpose(), single);
}

void SegmentTangent::reserve(Eigen::Index n) {
  values_.resize(static_cast<std::size_t>(n * sums_.padded_rows()));
  scratch_.resize(sums_.scratch(n));
}

void SegmentTangent::prepare(const double* displacements, Eigen::Index n) {
  sums_.multiply(displacements, n, values_.data(), scratch_.data());
}

// With q the motions, G q the turn of the frame, P its rigid motions of the strained segment and P' what
// strain adds to those at rest, N the change of the forces as they turn:
//   H = K + U G + G^T U^T + G^T C G,   U = N - K P',   C = P'^T K P' - sym(N^T P).
template <int size>
void SegmentTangent::add(const double* sums, Eigen::MatrixXd& stiffness) const {
  using Matrix = Eigen::Matrix<double, size, size>;
  using Columns = Eigen::Matrix<double, size, 3, Eigen::ColMajor, size == Eigen::Dynamic ? 60 : size, 3>;
  const Eigen::Index n = 6 * interfaces_;
  Columns turned(n, 3), rigid(n, 3), strained = Columns::Zero(n, 3);
  for (Eigen::Index i = 0; i < interfaces_; ++i) {
    const double* const s = sums + kSums * i;
    const Vec3 force(s[0], s[1], s[2]), moved(s[12], s[13], s[14]);
    const Eigen::Map<const Mat3> moments(s + 3);
    turned.template block<3, 3>(6 * i, 0) = -cross_matrix(force);
    turned.template block<3, 3>(6 * i + 3, 0) = moments.trace() * Mat3::Identity() - moments.transpose();
    strained.template block<3, 3>(6 * i, 0) = -cross_matrix(moved);
    rigid.template block<3, 3>(6 * i, 0) = -cross_matrix(centers_[static_cast<std::size_t>(i)] + moved);
    rigid.template block<3, 3>(6 * i + 3, 0).setIdentity();
  }
  const Eigen::Map<const Matrix> rest(rest_.data(), n, n);
  const Eigen::Map<const Eigen::Matrix<double, 3, size>> g(frame_.data(), 3, n);
  Columns pulled(n, 3);
  pulled.noalias() = rest.lazyProduct(strained);
  Mat3 c = turned.transpose().lazyProduct(rigid);
  c = (-0.5 * (c + c.transpose())).eval();
  c += strained.transpose().lazyProduct(pulled);
  // U G + G^T U^T + G^T C G = V G + (V G)^T with V = U + G^T C / 2.
  Columns v = turned - pulled;
  v += 0.5 * g.transpose().lazyProduct(c);
  Eigen::Map<Matrix> h(stiffness.data(), n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      h(i, j) += v(i, 0) * g(0, j) + v(i, 1) * g(1, j) + v(i, 2) * g(2, j) + v(j, 0) * g(0, i) +
                 v(j, 1) * g(1, i) + v(j, 2) * g(2, i);
    }
  }
}

void SegmentTangent::add_geometry(Eigen::Index column, Eigen::MatrixXd& stiffness) const {
  const double* const sums = values_.data() + column * sums_.padded_rows();
  if (interfaces_ == 2) {
    add<12>(sums, stiffness);
  } else {
    add<Eigen::Dynamic>(sums, stiffness);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

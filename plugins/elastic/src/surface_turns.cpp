#include "surface_turns.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "rotation_fit.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

Vec3 row_of(const double* points, Eigen::Index count, Eigen::Index k) {
  return {points[k], points[count + k], points[2 * count + k]};
}

void put_row(double* points, Eigen::Index count, Eigen::Index k, const Vec3& p) {
  for (Eigen::Index a = 0; a < 3; ++a) points[a * count + k] = p[a];
}

// From a turn in the turned frame to the change of the rotation vector v:
// 1 + [v]/2 + (1/t^2 - cot(t/2)/(2 t)) [v]^2, t = |v|.
Mat3 rate_of(const Vec3& v) {
  const double t = v.norm();
  const double c = t < 1e-2 ? (1.0 + t * t / 60.0) / 12.0 : 1.0 / (t * t) - 0.5 / (t * std::tan(0.5 * t));
  Mat3 cross;
  cross << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return Mat3::Identity() + 0.5 * cross + c * cross * cross;
}

}  // namespace

SurfaceTurns::SurfaceTurns(const SegmentModel& model, const Eigen::Matrix<double, Eigen::Dynamic, 3>& arms,
                           Eigen::Index n)
    : first_{0}, arms_(arms) {
  std::vector<Vec3> centers;
  for (const auto& interface : model.interfaces) {
    const auto size = static_cast<Eigen::Index>(interface.size());
    auto block = arms_.middleRows(first_.back(), size);
    centers.push_back(block.colwise().mean());
    block.rowwise() -= centers.back().transpose();
    first_.push_back(first_.back() + size);
  }
  turns_.resize(model.interfaces.size() * static_cast<std::size_t>(n));
  if (centers.size() != 2) return;
  bows_.resize(static_cast<std::size_t>(n));
  axis_ = (centers[1] - centers[0]).normalized();
  length_ = (centers[1] - centers[0]).norm();
  // K_p and K_q about two axes across, by turns of one and of one (minus one).
  const Eigen::Index size = 3 * arms_.rows();
  const Eigen::Map<const Eigen::MatrixXd> k(model.stiffness.data(), size, size);
  double against_difference = 0, against_sum = 0;
  const Vec3 first_across = axis_.unitOrthogonal();
  for (const Vec3& across : {first_across, Vec3(axis_.cross(first_across))}) {
    Eigen::VectorXd both(size), opposite(size);
    for (Eigen::Index i = 0; i < arms_.rows(); ++i) {
      const Vec3 turned = across.cross(Vec3(arms_.row(i)));
      put_row(both.data(), arms_.rows(), i, turned);
      put_row(opposite.data(), arms_.rows(), i, i < first_[1] ? turned : Vec3(-turned));
    }
    against_sum += both.dot(k * both);
    against_difference += opposite.dot(k * opposite);
  }
  shear_ = std::min(1.0, std::pow(against_sum / (3.0 * against_difference), 2));
}

std::array<Vec3, 2> SurfaceTurns::bow_moments(const Bow& bow, double force) const {
  const Vec3 p = 5.0 * bow.half_difference, q = 3.0 * shear_ * bow.half_sum;
  return {force * length_ / 30.0 * (p + q), force * length_ / 30.0 * (q - p)};
}

Vec3 SurfaceTurns::turned_back(const Turn& turn, const double* strain, Eigen::Index k) const {
  const Vec3 arm = arms_.row(k);
  return row_of(strain, arms_.rows(), k) - turn.strained_shift - turn.vector.cross(arm) + arm;
}

void SurfaceTurns::straighten(Eigen::Index column, const double* d, double* strain) {
  const Eigen::Index count = arms_.rows();
  const std::size_t interfaces = first_.size() - 1;
  for (std::size_t i = 0; i < interfaces; ++i) {
    Turn& turn = turns_[static_cast<std::size_t>(column) * interfaces + i];
    turn.shift.setZero();
    for (Eigen::Index k = first_[i]; k < first_[i + 1]; ++k) turn.shift += row_of(d, count, k);
    turn.shift /= static_cast<double>(first_[i + 1] - first_[i]);
    Mat3 moment = Mat3::Zero();
    for (Eigen::Index k = first_[i]; k < first_[i + 1]; ++k) {
      const Vec3 arm = arms_.row(k);
      moment += (arm + row_of(d, count, k) - turn.shift) * arm.transpose();
    }
    turn.rotation.setIdentity();  // not from the last one: the same points give the same strain
    fit_rotation(moment, turn.rotation, turn.fit);
    const Eigen::AngleAxisd log(turn.rotation);
    turn.vector = log.angle() * log.axis();
    turn.rate = rate_of(turn.vector);
  }
  Vec3 bowed = Vec3::Zero();
  if (!bows_.empty()) {
    Bow& bow = bows_[static_cast<std::size_t>(column)];
    const Turn* const turn = &turns_[static_cast<std::size_t>(column) * 2];
    const auto across = [&](const Vec3& v) -> Vec3 { return v - axis_ * axis_.dot(v); };
    const Vec3 line = axis_.cross(turn[1].shift - turn[0].shift) / length_;
    bow.half_difference = 0.5 * across(turn[0].vector - turn[1].vector);
    bow.half_sum = 0.5 * across(turn[0].vector + turn[1].vector) - line;
    bowed = length_ / 30.0 *
            (5.0 * bow.half_difference.squaredNorm() + 3.0 * shear_ * bow.half_sum.squaredNorm()) * axis_;
  }
  for (std::size_t i = 0; i < interfaces; ++i) {
    Turn& turn = turns_[static_cast<std::size_t>(column) * interfaces + i];
    const Vec3 shift = turn.shift + (i == 0 ? -0.5 : 0.5) * bowed;
    for (Eigen::Index k = first_[i]; k < first_[i + 1]; ++k) {
      const Vec3 arm = arms_.row(k);
      put_row(strain, count, k,
              shift + turn.vector.cross(arm) +
                  turn.rotation.transpose() * (arm + row_of(d, count, k) - turn.shift) - arm);
    }
    turn.strained_shift = shift;
  }
}

// With b = Q^T (X + d - s), a turn w of Q in its own frame follows the points by w = fit sum X x Q^T dd, and
// d~ by rate w x X - w x b.
void SurfaceTurns::turn_forces(Eigen::Index column, const double* strain, double* force) const {
  const Eigen::Index count = arms_.rows();
  const std::size_t interfaces = first_.size() - 1;
  const auto sum_of = [&](std::size_t i) {
    Vec3 sum = Vec3::Zero();
    for (Eigen::Index k = first_[i]; k < first_[i + 1]; ++k) sum += row_of(force, count, k);
    return sum;
  };
  std::array<Vec3, 2> bow = {Vec3::Zero(), Vec3::Zero()};
  if (!bows_.empty()) {
    bow = bow_moments(bows_[static_cast<std::size_t>(column)], 0.5 * axis_.dot(sum_of(1) - sum_of(0)));
  }
  const Vec3 line = axis_.cross(bow[0] + bow[1]) / (length_ > 0.0 ? length_ : 1.0);
  for (std::size_t i = 0; i < interfaces; ++i) {
    const Turn& turn = turns_[static_cast<std::size_t>(column) * interfaces + i];
    const auto size = static_cast<double>(first_[i + 1] - first_[i]);
    Vec3 of_vector = bows_.empty() ? Vec3(Vec3::Zero()) : bow[i], of_turn = Vec3::Zero();
    for (Eigen::Index k = first_[i]; k < first_[i + 1]; ++k) {
      const Vec3 g = row_of(force, count, k);
      of_vector += arms_.row(k).transpose().cross(g);
      of_turn += turned_back(turn, strain, k).cross(g);
    }
    const Vec3 n = turn.fit * (turn.rate.transpose() * of_vector - of_turn);
    // Of s: the mean of the forces, less that of the turned ones; and of the line between the interfaces.
    const Vec3 sum = sum_of(i), on_shift = i == 0 ? Vec3(-line) : line;
    const Vec3 mean = (sum - turn.rotation * sum + on_shift) / size;
    for (Eigen::Index k = first_[i]; k < first_[i + 1]; ++k) {
      const Vec3 arm = arms_.row(k);
      put_row(force, count, k, mean + turn.rotation * (row_of(force, count, k) + n.cross(arm)));
    }
  }
}

void SurfaceTurns::turn_change(Eigen::Index column, const double* strain, double* change) const {
  const Eigen::Index count = arms_.rows();
  const std::size_t interfaces = first_.size() - 1;
  std::array<Vec3, 2> shifts = {Vec3::Zero(), Vec3::Zero()}, vectors = shifts;
  for (std::size_t i = 0; i < interfaces; ++i) {
    const Turn& turn = turns_[static_cast<std::size_t>(column) * interfaces + i];
    Vec3 shift = Vec3::Zero(), moment = Vec3::Zero();
    for (Eigen::Index k = first_[i]; k < first_[i + 1]; ++k) {
      const Vec3 c = row_of(change, count, k);
      shift += c;
      moment += arms_.row(k).transpose().cross(turn.rotation.transpose() * c);
    }
    shift /= static_cast<double>(first_[i + 1] - first_[i]);
    const Vec3 w = turn.fit * moment, vector = turn.rate * w;
    for (Eigen::Index k = first_[i]; k < first_[i + 1]; ++k) {
      const Vec3 arm = arms_.row(k);
      put_row(change, count, k,
              shift + vector.cross(arm) + turn.rotation.transpose() * (row_of(change, count, k) - shift) -
                  w.cross(turned_back(turn, strain, k)));
    }
    if (bows_.empty()) continue;
    shifts[i] = shift;
    vectors[i] = vector;
  }
  if (bows_.empty()) return;
  const std::array<Vec3, 2> moments = bow_moments(bows_[static_cast<std::size_t>(column)], 1.0);
  const Vec3 line = axis_.cross(shifts[1] - shifts[0]) / length_;
  const Vec3 bowed = (moments[0].dot(vectors[0] - line) + moments[1].dot(vectors[1] - line)) * axis_;
  for (Eigen::Index k = 0; k < count; ++k) {
    put_row(change, count, k, row_of(change, count, k) + (k < first_[1] ? -0.5 : 0.5) * bowed);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#include "point_loads.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "softpoint/core/error.h"
#include "softpoint/elastic/elastic_body.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

using Eigen::Index;

Index at(std::size_t i) { return static_cast<Index>(i); }

void check_stiffness(std::span<const double> stiffness, std::size_t n) {
  if (stiffness.empty()) {
    return;
  }
  if (stiffness.size() != n * n) {
    throw Error("set_point_loads: stiffness has " + std::to_string(stiffness.size()) +
                " entries, permitted is 0 or " + std::to_string(n * n));
  }
  double largest = 0.0;
  for (const double k : stiffness) {
    check_range("set_point_loads: stiffness", k, -kMaxPointStiffness, kMaxPointStiffness);
    largest = std::max(largest, std::abs(k));
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      check_range("set_point_loads: stiffness, its asymmetry",
                  std::abs(stiffness[i + j * n] - stiffness[j + i * n]), 0.0, 1e-9 * largest);
    }
  }
}

}  // namespace

void PointLoads::set(std::span<const int> which, std::span<const Vec3> at_start,
                     std::span<const double> stiffness, std::size_t body_points) {
  if (which.size() != at_start.size()) {
    throw Error("set_point_loads: forces has " + std::to_string(at_start.size()) +
                " entries, permitted is one per point, " + std::to_string(which.size()));
  }
  for (const int p : which) {
    check_index("set_point_loads: point", p, static_cast<long long>(body_points));
  }
  for (const Vec3& f : at_start) {
    check_range("set_point_loads: force", f, -kMaxPointForce, kMaxPointForce);
  }
  check_stiffness(stiffness, 3 * which.size());
  if (!stiffness.empty()) {
    factor_stiffness(stiffness);
  } else {
    trial_rank_ = 0;
  }
  resize(which.size(), body_points);
  std::swap(factor_, trial_);
  rank_ = trial_rank_;
  points.assign(which.begin(), which.end());
  forces.assign(at_start.begin(), at_start.end());
}

void PointLoads::clear() {
  points.clear();
  forces.clear();
  end_forces.clear();
  rank_ = 0;
}

void PointLoads::resize(std::size_t count, std::size_t body_points) {
  const Index n = at(3 * count);
  for (Eigen::MatrixXd* m : {&factor_, &trial_, &stiffness_, &compliance, &springs, &moved_, &system_}) {
    if (m->rows() != n || m->cols() != n) {
      m->conservativeResize(n, n);
    }
  }
  for (Eigen::VectorXd* v : {&motion, &impulse, &reaction, &answer_}) {
    v->resize(n);
  }
  modes_.resize(n, 6);
  points.reserve(count);
  for (std::vector<Vec3>* v : {&forces, &applied, &end_forces}) {
    v->reserve(count);
  }
  applied_points.reserve(count);
  end_forces.resize(count, Vec3::Zero());
  touched_rows.reserve(9 * count * body_points);
  scratch_.resize(static_cast<std::size_t>(kernels_.scratch));
}

bool PointLoads::differ_from_applied(std::span<const int> which, std::span<const Vec3> at_start) const {
  constexpr double kRounding = 1e-9;
  double largest = 0.0, change = 0.0;
  const bool same = std::equal(which.begin(), which.end(), applied_points.begin(), applied_points.end());
  for (const Vec3& f : applied) {
    largest = std::max(largest, f.norm());
  }
  for (std::size_t i = 0; i < at_start.size(); ++i) {
    const double before = largest;
    largest = std::max(largest, at_start[i].norm());
    change = std::max(change, same ? (at_start[i] - applied[i]).norm() : before + largest);
  }
  if (!same && at_start.empty()) {
    change = largest;
  }
  return change > kRounding * largest;
}

// K = L L^T, Cholesky with the largest pivot next; rows that others have used up bring no column.
void PointLoads::factor_stiffness(std::span<const double> stiffness) {
  constexpr double kUsedUp = 1e-13, kNegative = 1e-9;
  // Whoever turns a stiffness leaves rounding of a point's largest entry in its smallest.
  constexpr double kTurned = 1e-5;
  const Index n = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(stiffness.size()))));
  trial_.resize(n, n);
  const Eigen::Map<const Eigen::MatrixXd> given(stiffness.data(), n, n);
  stiffness_ = given;
  diagonal_ = given.diagonal();
  used_.assign(static_cast<std::size_t>(n), 0);
  trial_rank_ = 0;
  for (;;) {
    Index pivot = -1;
    for (Index i = 0; i < n; ++i) {
      if (!used_[static_cast<std::size_t>(i)] && stiffness_(i, i) > kUsedUp * diagonal_[i] &&
          (pivot < 0 || stiffness_(i, i) > stiffness_(pivot, pivot))) {
        pivot = i;
      }
    }
    if (pivot < 0) {
      break;
    }
    used_[static_cast<std::size_t>(pivot)] = 1;
    auto column = trial_.col(trial_rank_++);
    const double scale = 1.0 / std::sqrt(stiffness_(pivot, pivot));
    for (Index i = 0; i < n; ++i) {
      column[i] = used_[static_cast<std::size_t>(i)] && i != pivot ? 0.0 : scale * stiffness_(i, pivot);
    }
    for (Index j = 0; j < n; ++j) {
      if (!used_[static_cast<std::size_t>(j)]) {
        stiffness_.col(j) -= column[j] * column;
      }
    }
  }
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      if (used_[static_cast<std::size_t>(i)] || used_[static_cast<std::size_t>(j)]) {
        continue;
      }
      const auto size = [&](Index k) {
        return std::max(diagonal_[k], kTurned * diagonal_.segment<3>(k - k % 3).maxCoeff());
      };
      const double bound = kNegative * std::sqrt(std::max(size(i), 0.0) * std::max(size(j), 0.0));
      if (!(std::abs(stiffness_(i, j)) <= bound)) {
        throw Error("set_point_loads: stiffness(" + std::to_string(i) + ", " + std::to_string(j) +
                    ") = " + to_text(given(i, j)) + ": permitted is what makes it positive semidefinite");
      }
    }
  }
}

void PointLoads::turn_springs(const std::vector<Vec3>& arms, const Mat3& turn) {
  const double n = count();
  Vec3 middle = Vec3::Zero();
  for (const int p : points) {
    middle += arms[static_cast<std::size_t>(p)] / n;
  }
  Mat3 inertia = Mat3::Zero();
  for (const int p : points) {
    const Vec3 r = arms[static_cast<std::size_t>(p)] - middle;
    inertia += r.squaredNorm() * Mat3::Identity() - r * r.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia);
  Index modes = 0;
  for (int axis = 0; axis < 3; ++axis, ++modes) {
    for (Index i = 0; i < at(points.size()); ++i) {
      modes_.col(modes).segment<3>(3 * i) = Vec3::Unit(axis) / std::sqrt(n);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double value = eigen.eigenvalues()[axis];
    if (!(value > 1e-12 * eigen.eigenvalues()[2])) {
      continue;  // a single point, or points in a line: this turn moves none of them
    }
    for (Index i = 0; i < at(points.size()); ++i) {
      const Vec3 r = arms[static_cast<std::size_t>(points[static_cast<std::size_t>(i)])] - middle;
      modes_.col(modes).segment<3>(3 * i) = eigen.eigenvectors().col(axis).cross(r) / std::sqrt(value);
    }
    ++modes;
  }
  for (Index k = 0; k < rank_; ++k) {
    auto column = springs.col(k);
    column = factor_.col(k);
    for (int twice = 0; twice < 2; ++twice) {  // once more for the rounding of the first
      for (Index m = 0; m < modes; ++m) {
        column -= modes_.col(m).dot(column) * modes_.col(m);
      }
    }
    for (Index i = 0; i < at(points.size()); ++i) {
      const Vec3 local = turn * column.segment<3>(3 * i);
      column.segment<3>(3 * i) = local;
    }
  }
}

void PointLoads::factor(double h) {
  for (Index k = 0; k < rank_; ++k) {
    moved_.col(k).noalias() = compliance * springs.col(k);
  }
  for (Index k = 0; k < rank_; ++k) {
    for (Index i = k; i < rank_; ++i) {
      system_(i, k) = h * h * springs.col(i).dot(moved_.col(k));
    }
    system_(k, k) += 1.0;
  }
  kernels_.cholesky(system_.data(), rank_, system_.rows(), scratch_.data());
}

void PointLoads::solve(const Eigen::VectorXd& given) {
  auto y = answer_.head(rank_);
  for (Index k = 0; k < rank_; ++k) {
    y[k] = springs.col(k).dot(given);
  }
  for (Index k = 0; k < rank_; ++k) {
    y[k] /= system_(k, k);
    const double value = y[k];
    for (Index i = k + 1; i < rank_; ++i) {
      y[i] -= system_(i, k) * value;
    }
  }
  for (Index k = rank_ - 1; k >= 0; --k) {
    double value = y[k];
    for (Index i = k + 1; i < rank_; ++i) {
      value -= system_(i, k) * y[i];
    }
    y[k] = value / system_(k, k);
  }
}

void PointLoads::take_springs(double h, Eigen::VectorXd& result) const {
  for (Index k = 0; k < rank_; ++k) {
    result -= h * answer_[k] * springs.col(k);
  }
}

void PointLoads::divide(double* rows, Index m) {
  kernels_.divide_transposed(rows, m, m, system_.data(), rank_, system_.rows(), scratch_.data());
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

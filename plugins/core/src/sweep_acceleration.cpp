#include "sweep_acceleration.h"

#include <Eigen/Cholesky>

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Of the least change of a sweep so far: beyond, what was extrapolated led astray.
constexpr double kAstray = 3.0;

}  // namespace

void SweepAcceleration::begin(std::size_t contacts) {
  size_ = 3 * static_cast<Eigen::Index>(contacts);
  if (before_.size() < size_) {
    const Eigen::Index room = size_ + size_ / 2;
    weights_.resize(room / 3 + 1);
    for (Eigen::VectorXd* v : {&before_, &after_, &change_, &last_change_, &last_after_}) v->resize(room);
    changes_.resize(room, kMemory);
    afters_.resize(room, kMemory);
  }
  pairs_ = newest_ = 0;
  known_ = false;
}

bool SweepAcceleration::improve() {
  auto change = change_.head(size_);
  change = after_.head(size_) - before_.head(size_);
  for (Eigen::Index i = 0; i < size_; i += 3) change.segment<3>(i) *= weights_[i / 3];
  const double now = change.norm();
  if (known_) {
    newest_ = (newest_ + 1) % kMemory;
    changes_.col(newest_).head(size_) = change - last_change_.head(size_);
    afters_.col(newest_).head(size_) = after_.head(size_) - last_after_.head(size_);
    pairs_ = std::min(pairs_ + 1, kMemory);
  }
  last_change_.head(size_) = change;
  last_after_.head(size_) = after_.head(size_);
  least_ = known_ ? std::min(least_, now) : now;
  known_ = true;
  if (!(now <= kAstray * least_)) {
    pairs_ = 0;
    known_ = false;
    return false;
  }
  if (pairs_ == 0) return false;
  // The mean of the last sweeps whose change is least.
  Eigen::Matrix<double, kMemory, kMemory> form = Eigen::Matrix<double, kMemory, kMemory>::Zero();
  Eigen::Matrix<double, kMemory, 1> side = Eigen::Matrix<double, kMemory, 1>::Zero();
  const auto column = [&](Eigen::Index i) { return (newest_ - i + kMemory) % kMemory; };
  for (Eigen::Index i = 0; i < pairs_; ++i) {
    const auto a = changes_.col(column(i)).head(size_);
    side[i] = a.dot(change);
    for (Eigen::Index j = 0; j <= i; ++j)
      form(i, j) = form(j, i) = a.dot(changes_.col(column(j)).head(size_));
  }
  const double trace = form.trace();
  if (!(trace > 0.0)) return false;
  form.diagonal().array() += 1e-10 * trace;  // and where there is no pair yet
  side = form.ldlt().solve(side).eval();
  if (!side.allFinite()) return false;
  for (Eigen::Index i = 0; i < pairs_; ++i)
    after_.head(size_) -= side[i] * afters_.col(column(i)).head(size_);
  return true;
}

}  // namespace softpoint::inline SOFTPOINT_ABI

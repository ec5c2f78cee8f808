#include "softpoint/elastic/incremental_statics.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <string>

#include "softpoint/core/error.h"
#include "softpoint/elastic/material.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

// Updates after which all is summed anew.
constexpr int kRefresh = 1000;

}  // namespace

IncrementalStatics::IncrementalStatics(std::shared_ptr<const BoundaryStiffness> stiffness, double young,
                                       std::span<const char> held)
    : stiffness_(std::move(stiffness)), held_(held.begin(), held.end()) {
  if (stiffness_ == nullptr) {
    throw Error("IncrementalStatics: stiffness is null; permitted is one of assemble_stiffness");
  }
  check_range("IncrementalStatics: young", young, kMinYoung, kMaxYoung);
  const auto n = static_cast<std::size_t>(stiffness_->dofs());
  if (held_.size() != n) {
    throw Error("IncrementalStatics: held has " + std::to_string(held_.size()) + " flags; permitted are " +
                std::to_string(n) + ", one for each degree of freedom");
  }
  std::vector<Eigen::Index> free, fixed;
  for (std::size_t i = 0; i < n; ++i) {
    (held_[i] != 0 ? fixed : free).push_back(static_cast<Eigen::Index>(i));
  }
  const auto size = static_cast<Eigen::Index>(n);
  const Eigen::Map<const Eigen::MatrixXd> unit(stiffness_->unit_stiffness.data(), size, size);
  const Eigen::MatrixXd s_ff = young * unit(free, free), s_fc = young * unit(free, fixed);
  const Eigen::LLT<Eigen::MatrixXd> factor(s_ff);
  const auto pivots = factor.matrixLLT().diagonal();
  if (!free.empty() && (factor.info() != Eigen::Success || pivots.minCoeff() < 1e-7 * pivots.maxCoeff())) {
    throw Error("IncrementalStatics: held leaves the body loose; permitted are holders of all rigid motions");
  }
  // u_f = S_ff^-1 f_f - S_ff^-1 S_fc u_c,  f_c = (S_cc - S_cf S_ff^-1 S_fc) u_c + S_cf S_ff^-1 f_f.
  columns_.resize(n * n);
  Eigen::Map<Eigen::MatrixXd> columns(columns_.data(), size, size);
  const Eigen::MatrixXd response = -factor.solve(s_fc);
  const auto count = static_cast<Eigen::Index>(free.size());
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(count, count));
  columns(free, free) = inverse;
  columns(free, fixed) = response;
  columns(fixed, fixed) = young * unit(fixed, fixed) + s_fc.transpose() * response;
  columns(fixed, free) = -response.transpose();
  known_.assign(n, 0.0);
  applied_.assign(n, 0.0);
  displacement_.assign(n, 0.0);
  force_.assign(n, 0.0);
  changed_.reserve(n);
}

void IncrementalStatics::set(int dof, double value) {
  check_index("set: dof", dof, static_cast<long long>(known_.size()));
  check_finite("set: value", value);
  double& known = known_[static_cast<std::size_t>(dof)];
  if (known == value) return;
  nonzero_ += (value != 0.0 ? 1 : 0) - (known != 0.0 ? 1 : 0);
  const bool listed = known != applied_[static_cast<std::size_t>(dof)];
  known = value;
  if (!listed) changed_.push_back(dof);
  if (listed && value == applied_[static_cast<std::size_t>(dof)]) std::erase(changed_, dof);
}

void IncrementalStatics::add_column(int dof, double change) {
  const std::size_t n = held_.size();
  const double* const column = columns_.data() + static_cast<std::size_t>(dof) * n;
  for (std::size_t i = 0; i < n; ++i) (held_[i] != 0 ? force_ : displacement_)[i] += change * column[i];
}

int IncrementalStatics::update() {
  if (changed_.empty()) return 0;
  int multiplied = 0;
  const bool anew = nonzero_ <= static_cast<int>(changed_.size()) || ++updates_ % kRefresh == 0;
  if (anew) {
    for (std::size_t i = 0; i < held_.size(); ++i) (held_[i] != 0 ? force_ : displacement_)[i] = 0.0;
    for (std::size_t i = 0; i < known_.size(); ++i) {
      if (known_[i] == 0.0) continue;
      add_column(static_cast<int>(i), known_[i]);
      ++multiplied;
    }
  } else {
    for (const int dof : changed_) {
      add_column(dof, known_[static_cast<std::size_t>(dof)] - applied_[static_cast<std::size_t>(dof)]);
      ++multiplied;
    }
  }
  for (const int dof : changed_) {
    const auto i = static_cast<std::size_t>(dof);
    applied_[i] = known_[i];
    (held_[i] != 0 ? displacement_ : force_)[i] = known_[i];
  }
  changed_.clear();
  return multiplied;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

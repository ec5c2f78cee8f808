#include "joint_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

// Iterations between two factorings of the joints' modes: frames hardly turn in fewer.
constexpr int kRefactor = 4;
// So much slower than others are ends that are held by a point to leave where they were carried while the
// skin is pushed: they are what shows that a part spins about its ends, which nothing else resists, and
// contacts along a part that spins at a touch answer one another for ever.
constexpr double kSlowEnd = 300.0;

double slowness(const PartGroup::Joint& joint, const std::vector<char>& held) {
  const auto first = held.begin() + joint.first;
  const auto pins = std::count_if(first, first + joint.count, [](char h) { return h != 0; });
  return pins > 0 && pins < joint.count ? kSlowEnd : 1.0;
}

}  // namespace

JointSolver::JointSolver(PartGroup& group, const Kernels& kernels, bool single)
    : group_(group), single_(single), modes_(group, kernels, single), factor_(group, kernels) {
  const Eigen::Index n = group.size();
  for (Eigen::VectorXd* v :
       {&inertia_, &gradient_, &free_gradient_, &direction_, &trial_, &trial_gradient_}) {
    v->setZero(n);
  }
  steps_.setZero(n, kMemory);
  changes_.setZero(n, kMemory);
  curvature_.assign(kMemory, 0.0);
  alpha_.assign(kMemory, 0.0);
}

void JointSolver::prepare(const std::vector<char>& held, const Eigen::VectorXd& inertia) {
  held_ = held;
  for (const PartGroup::Joint& joint : group_.joints()) {
    for (Eigen::Index i = 0; i < joint.count; ++i) {
      for (Eigen::Index a = 0; a < 3; ++a) {
        inertia_[3 * joint.first + a * joint.count + i] = inertia[joint.first + i];
      }
    }
  }
  const BlockRows rows = group_.rest_stiffness(held, inertia);
  find_greatest(rows);
  modes_.prepare(held, inertia, rows);
  factor_old_ = true;
}

// Power iteration.
void JointSolver::find_greatest(const BlockRows& rows) {
  const auto& joints = group_.joints();
  Eigen::VectorXd v(group_.size()), w(group_.size());
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = std::sin(1.0 + 1.7 * static_cast<double>(i));
  for (int sweep = 0; sweep < 100; ++sweep) {
    v.normalize();
    w.setZero();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (const auto& [j, block] : rows[i]) {
        w.segment(3 * joints[i].first, 3 * joints[i].count).noalias() +=
            block * v.segment(3 * joints[j].first, 3 * joints[j].count);
      }
    }
    greatest_ = w.norm();
    v.swap(w);
  }
}

void JointSolver::follow_frames() {
  group_.update_turns();
  modes_.factor();
}

double JointSolver::evaluate(const Eigen::VectorXd& x, const Eigen::VectorXd& toward) {
  factor_old_ = true;
  double energy = group_.evaluate(x, gradient_);
  for (const PartGroup::Joint& joint : group_.joints()) {
    const double slow = drag_ > 0.0 ? drag_ * slowness(joint, held_) : 0.0;
    for (Eigen::Index i = 3 * joint.first; i < 3 * (joint.first + joint.count); ++i) {
      const double away = x[i] - toward[i];
      const double c = inertia_[i] + slow;
      energy += 0.5 * c * away * away;
      gradient_[i] += c * away;
    }
  }
  free_gradient_ = gradient_;
  mask(free_gradient_);
  return energy;
}

// Below a billionth of what would strain the parts by one, forces are no measure.
double JointSolver::residual_of() const {
  return free_gradient_.norm() / (group_.force_scale() + 1e-9 * group_.stiffness_scale());
}

// Forces of parts at rest are what rounding of their points makes of them.
bool JointSolver::balanced(double tolerance, const Eigen::VectorXd& x) const {
  const double rounding = 8.0 * std::numeric_limits<double>::epsilon() * x.cwiseAbs().maxCoeff() /
                          group_.spacing() * group_.stiffness_scale() *
                          std::sqrt(static_cast<double>(x.size()));
  return free_gradient_.norm() <=
         tolerance * (group_.force_scale() + 1e-9 * group_.stiffness_scale()) + rounding;
}

void JointSolver::respond(double* x, Eigen::Index rows, Eigen::Index ldx, std::vector<double>& scratch) {
  if (factor_old_) {
    trial_ = inertia_;
    for (const PartGroup::Joint& joint : group_.joints()) {
      trial_.segment(3 * joint.first, 3 * joint.count).array() += steady() * slowness(joint, held_);
    }
    factor_.factor(held_, trial_, 0.0, scratch);
    factor_old_ = false;
  }
  factor_.solve(x, rows, ldx, scratch);
}

void JointSolver::mask(Eigen::VectorXd& v) const {
  for (const PartGroup::Joint& joint : group_.joints()) {
    for (Eigen::Index i = 0; i < joint.count; ++i) {
      if (held_[static_cast<std::size_t>(joint.first + i)] == 0) continue;
      for (Eigen::Index a = 0; a < 3; ++a) v[3 * joint.first + a * joint.count + i] = 0.0;
    }
  }
}

// The two loops of limited-memory BFGS round the compliance of the joints' modes.
void JointSolver::direction(int pairs, int newest) {
  trial_ = free_gradient_;
  for (int k = 0; k < pairs; ++k) {
    const int i = (newest - k + kMemory) % kMemory;
    const auto s = static_cast<std::size_t>(i);
    alpha_[s] = steps_.col(i).dot(trial_) / curvature_[s];
    trial_.noalias() -= alpha_[s] * changes_.col(i);
  }
  modes_.apply(trial_, direction_);
  for (int k = pairs - 1; k >= 0; --k) {
    const int i = (newest - k + kMemory) % kMemory;
    const auto s = static_cast<std::size_t>(i);
    const double beta = changes_.col(i).dot(direction_) / curvature_[s];
    direction_.noalias() += (alpha_[s] - beta) * steps_.col(i);
  }
  direction_ = -direction_;
}

JointSolver::Outcome JointSolver::relax(const AssemblySettings& settings, double kappa, Eigen::VectorXd& x,
                                        const Eigen::VectorXd& toward) {
  Outcome out;
  out.energy = evaluate(x, toward);
  out.evaluations = 1;
  while (out.iterations < settings.max_iterations && !balanced(settings.tolerance, x)) {
    x.noalias() -= kappa * free_gradient_;  // (4)
    out.energy = evaluate(x, toward);
    ++out.evaluations;
    ++out.iterations;
  }
  out.residual = residual_of();
  out.balanced = balanced(settings.tolerance, x);
  return out;
}

JointSolver::Outcome JointSolver::solve(const AssemblySettings& settings, double kappa, Eigen::VectorXd& x,
                                        const Eigen::VectorXd& toward) {
  if (settings.method == JointMethod::kRichardson) return relax(settings, kappa, x, toward);
  Outcome out;
  double energy = evaluate(x, toward);
  out.evaluations = 1;
  int pairs = 0, newest = kMemory - 1;
  const double longest = 0.5 * group_.spacing();
  while (out.iterations < settings.max_iterations && !balanced(settings.tolerance, x)) {
    if (out.iterations % kRefactor == 0) {
      follow_frames();
    } else {
      group_.update_turns();
    }
    direction(pairs, newest);
    double slope = direction_.dot(free_gradient_);
    if (!(slope < 0.0)) {  // memory from elsewhere: begin again
      pairs = 0;
      direction(0, newest);
      slope = direction_.dot(free_gradient_);
      if (!(slope < 0.0)) break;
    }
    const double largest = direction_.cwiseAbs().maxCoeff();
    double length = largest > longest ? longest / largest : 1.0;
    trial_gradient_ = free_gradient_;
    // Energies agree to rounding near balance; then less slope along the way is what counts.
    const double terms = std::abs(energy) + group_.energy_scale() + group_.loads.norm() * x.norm();
    const double rounding = (single_ ? 1e-7 : 1e-13) * terms;
    bool better = false;
    double next = energy;
    for (int cut = 0; cut < 12 && !better; ++cut) {
      trial_ = x + length * direction_;
      next = evaluate(trial_, toward);
      ++out.evaluations;
      const double end_slope = direction_.dot(free_gradient_);
      better = next <= energy + 1e-4 * length * slope ||
               (next <= energy + rounding && std::abs(end_slope) <= 0.9 * std::abs(slope));
      // To where the slope would vanish.
      if (!better) length *= end_slope > 0.0 ? std::clamp(slope / (slope - end_slope), 0.1, 0.5) : 0.5;
    }
    if (!better) {
      energy = evaluate(x, toward);  // the segments' frames belong to x again
      ++out.evaluations;
      if (pairs == 0) break;
      pairs = 0;
      continue;
    }
    newest = (newest + 1) % kMemory;
    steps_.col(newest) = trial_ - x;
    changes_.col(newest) = free_gradient_ - trial_gradient_;
    curvature_[static_cast<std::size_t>(newest)] = steps_.col(newest).dot(changes_.col(newest));
    const bool convex = curvature_[static_cast<std::size_t>(newest)] >
                        1e-10 * steps_.col(newest).norm() * changes_.col(newest).norm();
    if (convex) {
      pairs = std::min(pairs + 1, kMemory);
    } else {
      newest = (newest - 1 + kMemory) % kMemory;
    }
    x.swap(trial_);
    energy = next;
    ++out.iterations;
  }
  out.energy = energy;
  out.residual = residual_of();
  out.balanced = balanced(settings.tolerance, x);
  return out;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

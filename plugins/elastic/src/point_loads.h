#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "kernels.h"
#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Loads on some points of an ElasticBody (doc/elastic_dynamics.md, L1 to L5): what was set, and the small
// matrices of the step at work. Everything "local" is in the frame R of that step.
class PointLoads {
 public:
  explicit PointLoads(const Kernels& kernels) : kernels_(kernels) {}

  bool active() const { return !points.empty(); }
  int count() const { return static_cast<int>(points.size()); }
  // Directions in which the springs resist, at most 3 n.
  Eigen::Index rank() const { return rank_; }

  // Throws Error, nothing changed, for a stiffness that is not symmetric and positive semidefinite.
  // `body_points` is the number of points of the body, for scratch.
  void set(std::span<const int> which, std::span<const Vec3> at_start, std::span<const double> stiffness,
           std::size_t body_points);
  // Keeps the storage.
  void clear();
  // Of the forces of the step last begun, beyond rounding?
  bool differ_from_applied(std::span<const int> which, std::span<const Vec3> at_start) const;

  // Springs of the step: turn P L, with the best-fit rigid motion of the points at `arms` taken out: N.
  void turn_springs(const std::vector<Vec3>& arms, const Mat3& turn);
  // A = 1 + h^2 (turn P L)^T G (turn P L), factored (L3); G in `compliance`.
  void factor(double h);
  // Solves A y = (turn P L)^T given for y, which take_springs() wants.
  void solve(const Eigen::VectorXd& given);
  // result -= h (turn P L) y.
  void take_springs(double h, Eigen::VectorXd& result) const;
  // rows (m x rank, column-major, leading dimension m) <- rows * (lower factor of A)^-T.
  void divide(double* rows, Eigen::Index m);

  std::vector<int> points;
  std::vector<Vec3> forces;  // N, world, at the start of the step
  std::vector<int> applied_points;
  std::vector<Vec3> applied;         // N, what the last step began with
  std::vector<Vec3> end_forces;      // N, world, at its end
  Mat3 frame = Mat3::Identity();     // R when `impulse` was found
  Eigen::MatrixXd compliance;        // local G, 3n x 3n
  Eigen::MatrixXd springs;           // local turn P L; `rank` columns in use
  Eigen::VectorXd motion;            // 3n, scratch
  Eigen::VectorXd impulse;           // N s, local, without impulses from outside
  Eigen::VectorXd reaction;          // N s, local, to those
  std::vector<double> touched_rows;  // 3t x rank

 private:
  void resize(std::size_t count, std::size_t body_points);
  void factor_stiffness(std::span<const double> stiffness);

  const Kernels& kernels_;
  Eigen::Index rank_ = 0, trial_rank_ = 0;
  Eigen::MatrixXd stiffness_, trial_, factor_;  // K being eaten up, L on trial, L
  Eigen::VectorXd diagonal_;
  std::vector<char> used_;
  Eigen::MatrixXd modes_;  // 3n x 6, orthonormal rigid motions of the points
  Eigen::MatrixXd moved_, system_;
  Eigen::VectorXd answer_;
  std::vector<double> scratch_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

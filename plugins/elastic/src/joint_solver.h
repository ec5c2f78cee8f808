#pragma once

#include <vector>

#include "joint_factor.h"
#include "joint_modes.h"
#include "part_group.h"
#include "softpoint/elastic/assembly_settings.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Finds where the points of a group's joints are in balance.
class JointSolver {
 public:
  JointSolver(PartGroup& group, const Kernels& kernels, bool single);

  // Which points are held where they are put, and c (kg/s2) of the energy c/2 |x - x^|^2 of each point.
  // Factors the stiffness of the rest pose anew: never within a step.
  void prepare(const std::vector<char>& held, const Eigen::VectorXd& inertia);

  struct Outcome {
    int iterations = 0;   // steps taken
    int evaluations = 0;  // of energy and forces
    double residual = 0;  // imbalance over the joint forces
    double energy = 0;    // J
    bool balanced = false;
  };
  // From `x`, held points included, to `x`. `toward` holds x^.
  Outcome solve(const AssemblySettings& settings, double kappa, Eigen::VectorXd& x,
                const Eigen::VectorXd& toward);
  // Energy and forces at `x`, inertia included, without a step.
  double evaluate(const Eigen::VectorXd& x, const Eigen::VectorXd& toward);
  // Imbalance at the last evaluation: gradient (N) of all points. At held ones it is the force of the holder.
  const Eigen::VectorXd& gradient() const { return gradient_; }
  // Joint forces (N) become the displacements (m) they cause at the shape of the last evaluation, frames
  // held: row by row of x, which has `rows` of them, ldx numbers from column to column. `scratch` may be
  // shared.
  void respond(double* x, Eigen::Index rows, Eigen::Index ldx, std::vector<double>& scratch);
  // Greatest eigenvalue of the stiffness at rest, N/m: (4) converges for kappa below 2 over it.
  double greatest_stiffness() const { return greatest_; }
  const std::vector<char>& held() const { return held_; }
  // N/m of each point against leaving x^, on top of the inertia: as much as steady() while something pushes
  // the skin, else 0.
  void set_drag(double drag) { drag_ = drag; }
  // What keeps parts that are held by points from spinning about them under a push: next to nothing beside
  // their own stiffness. Part of every respond().
  double steady() const { return 1e-5 * group_.stiffness_scale() / group_.spacing(); }

 private:
  static constexpr int kMemory = 8;
  double residual_of() const;
  bool balanced(double tolerance, const Eigen::VectorXd& x) const;
  void follow_frames();
  void mask(Eigen::VectorXd& v) const;
  void direction(int pairs, int newest);
  Outcome relax(const AssemblySettings& settings, double kappa, Eigen::VectorXd& x,
                const Eigen::VectorXd& toward);
  void find_greatest(const BlockRows& rows);

  PartGroup& group_;
  bool single_;
  double drag_ = 0;
  bool factor_old_ = true;  // frames have moved since the factor of respond()
  JointModes modes_;
  JointFactor factor_;
  std::vector<char> held_;
  Eigen::VectorXd inertia_;  // one a coordinate
  Eigen::VectorXd gradient_, free_gradient_, direction_, trial_, trial_gradient_;
  Eigen::MatrixXd steps_, changes_;
  std::vector<double> curvature_, alpha_;
  double greatest_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

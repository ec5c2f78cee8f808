#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <vector>

#include "joint_graph.h"
#include "kernels.h"
#include "part_group.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Cholesky factor of the stiffness that a group's joints have in the shape of the last evaluate(), the
// segments' frames held: block by block along the joints, in double precision. Costs about as much as one
// column of conjugate gradients, and any number of loads is solved for at once. Takes its memory when it is
// first used.
class JointFactor {
 public:
  JointFactor(const PartGroup& group, const Kernels& kernels)
      : group_(group), kernels_(kernels), graph_(group, true) {}

  // Held points stay; `diagonal` (N/m, one a coordinate) and `steady` (N/m) are added to all others.
  // `scratch` grows to what it wants and may be shared with others.
  void factor(const std::vector<char>& held, const Eigen::VectorXd& diagonal, double steady,
              std::vector<double>& scratch);
  // Forces (N) of all points become the displacements (m) they cause: row by row of x, which has `rows` of
  // them, ldx numbers from column to column.
  void solve(double* x, Eigen::Index rows, Eigen::Index ldx, std::vector<double>& scratch) const;

 private:
  void reserve(std::vector<double>& scratch);
  void add_segments();
  void add_bones();
  void mask(const std::vector<char>& held, double steady, double shift);
  bool eliminate(double* scratch);
  // Block of two joints, transposed when the first is eliminated after the second.
  struct Block {
    Eigen::MatrixXd* matrix = nullptr;
    bool transposed = false;
  };
  Block block_of(int a, int b);

  const PartGroup& group_;
  const Kernels& kernels_;
  JointGraph graph_;
  std::vector<char> held_;
  std::vector<Eigen::MatrixXd> diagonal_, links_;  // of each joint; {later, first} of each link
  Eigen::MatrixXd turned_, half_turned_;           // stiffness of one segment, in the world
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#pragma once

#include <Eigen/Core>

#include <vector>

#include "joint_graph.h"
#include "part_group.h"
#include "segment_tangent.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// A compliance of a group's joints for the shape they have: each joint's motion as a rigid body (six modes, a
// chain or tree of 6 x 6 blocks, factored anew in every solve), plus its warping by its own stiffness at
// rest. Soft modes of long bent chains are in the first part, and all that is stiff is in the second.
class JointModes {
 public:
  JointModes(const PartGroup& group, const Kernels& kernels, bool single);

  // For these held points, at rest: never within a step. `rows` is the stiffness there.
  void prepare(const std::vector<char>& held, const Eigen::VectorXd& inertia, const BlockRows& rows);
  // For the frames the segments and joints have now.
  void factor();
  // Joint displacements by joint forces.
  void apply(const Eigen::VectorXd& force, Eigen::VectorXd& displacement);

 private:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  struct Node {
    Eigen::Matrix<double, Eigen::Dynamic, 6> modes;  // of the joint's points at rest, axis-major; held: zero
    int warping = 0;                                 // of warpings_
    int column = 0;                                  // among its joints
    Matrix6 rest_inertia = Matrix6::Zero();
    Vector6 scale = Vector6::Ones();  // by which the joint's own stiffness becomes one
    bool held = false;                // all of it: no modes
    bool pinned = false;              // some points of it
    Matrix6 inverse = Matrix6::Zero();
    Vector6 value = Vector6::Zero();
  };
  // A block below the diagonal: {eliminated first, later}.
  struct Link {
    Matrix6 stiffness = Matrix6::Zero(), lower = Matrix6::Zero();
  };
  struct Warping {
    Eigen::MatrixXd matrix;
    Product product;
    std::vector<int> joints;
    std::vector<double> in, out;
  };

  const PartGroup& group_;
  const Kernels& kernels_;
  bool single_;
  std::vector<Node> nodes_;
  JointGraph graph_;
  std::vector<Link> links_;
  std::vector<Warping> warpings_;
  // Stiffness of segments of one model, held alike, against rigid motions of their I interfaces, 6I x 6I.
  struct Kind {
    int model = 0;
    std::vector<char> pins;
    Eigen::MatrixXd stiffness;
  };
  std::vector<SegmentTangent> tangents_;   // of each model
  std::vector<Eigen::Index> segments_of_;  // how many of each there are
  std::vector<Eigen::MatrixXd> tangent_;   // of one segment, by the number of its interfaces
  std::vector<Kind> kinds_;
  std::vector<int> segment_stiffness_;  // of kinds_
  std::vector<float> scratch_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#pragma once

#include <Eigen/Core>

#include <vector>

#include "part_group.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Stiffness of a model's segments against rigid motions of their interfaces (six each: translations,
// rotations about the mean of its points), in the segment's frame: that at rest, and what strain and the
// forces it carries add as the frame turns with the interfaces (doc/joined_segments.md, (J7)).
class SegmentTangent {
 public:
  explicit SegmentTangent(const PackedModel& packed, bool single);

  const Eigen::MatrixXd& modes() const { return modes_; }  // of the joint points, 3J x 6I
  // For `n` segments by their displacements, column by column; without allocation once reserve(n) was called.
  void reserve(Eigen::Index n);
  void prepare(const double* displacements, Eigen::Index n);
  // Adds what strain and forces make of segment `column` to its stiffness at rest (6I x 6I).
  void add_geometry(Eigen::Index column, Eigen::MatrixXd& stiffness) const;

 private:
  template <int size>
  void add(const double* sums, Eigen::MatrixXd& stiffness) const;

  Eigen::Index interfaces_ = 0;
  Eigen::MatrixXd modes_;
  Eigen::MatrixXd rest_;        // 6I x 6I
  Eigen::Matrix3Xd frame_;      // turn of the frame by these motions
  std::vector<Vec3> centers_;   // m, of the interfaces from the mean of all joint points
  Product sums_;                // of forces, of moments (all nine), mean displacement: 15 rows an interface
  std::vector<double> values_;  // padded rows x n
  std::vector<float> scratch_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#pragma once

#include <Eigen/Core>

#include <vector>

#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// The rigid motions of a body that its holders leave free.
class FreeRigidModes {
 public:
  // `held` has one flag per degree of freedom (3 v + component).
  FreeRigidModes(const TriangleMesh& mesh, const Vec3& centre, const std::vector<char>& held);

  int count() const { return static_cast<int>(modes_.cols()); }
  // 3V x count, zero at held components; orthonormal columns.
  const Eigen::MatrixXd& modes() const { return modes_; }

  // The part of a load along the free motions: force and moment about the centre, N and N m.
  struct Wrench {
    Vec3 force, moment;
    double relative;  // against the sum of |force| of the vertices (times the size of the body, for moments)
  };
  Wrench resultant(const Eigen::VectorXd& load) const;

  // u without its part along the free motions, in the mean over `weight` (one a vertex).
  void remove_from(Eigen::VectorXd& displacement, const std::vector<double>& weight) const;

 private:
  double size_ = 0;
  Eigen::MatrixXd motions_;  // 3V x 6: translations, rotations about the centre over `size_`
  Eigen::MatrixXd free_;     // 6 x count: which combinations are free, orthonormal columns
  Eigen::MatrixXd modes_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

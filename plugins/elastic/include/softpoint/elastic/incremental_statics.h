#pragma once

#include <memory>
#include <span>
#include <vector>

#include "softpoint/core/config.h"
#include "softpoint/elastic/boundary_stiffness.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Elastostatics of one body by the paper's equation (3): X' = X - (A^-1 H) dU + (A^-1 G) dT, here in nodal
// displacements and nodal forces. Which of the two is known at each degree of freedom is fixed for good; then
// only known values that changed are multiplied. For bodies poked at a few places (segments joined to others
// have their condensed blocks, see SegmentModel).
//
// Degrees of freedom are vertex-major, 3 v + axis. All known values are zero at first: the rest shape.
class SOFTPOINT_API IncrementalStatics {
 public:
  // `held` has one flag for each degree of freedom: 1 where the displacement is known, 0 where the force is.
  // Throws Error for no stiffness, a Young's modulus out of range, a wrong number of flags, and for holders
  // that leave the body loose.
  IncrementalStatics(std::shared_ptr<const BoundaryStiffness> stiffness, double young,
                     std::span<const char> held);

  // A known value from the next update on: displacement (m) where held, force (N) elsewhere. Throws Error for
  // an index out of range or a number that is not finite.
  void set(int dof, double value);
  // Brings the unknowns up to date; returns how many columns were multiplied. Sums anew from the rest shape
  // where that takes no more of them, and now and then, so that rounding does not build up.
  int update();

  // Displacements (m) and nodal forces (N), known and unknown, as of the last update.
  std::span<const double> displacement() const { return displacement_; }
  std::span<const double> force() const { return force_; }

 private:
  void add_column(int dof, double change);

  std::shared_ptr<const BoundaryStiffness> stiffness_;
  std::vector<char> held_;
  std::vector<double> columns_;  // 3V x 3V: unknowns by known values
  std::vector<double> known_, applied_;
  std::vector<double> displacement_, force_;
  std::vector<int> changed_;
  int nonzero_ = 0, updates_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

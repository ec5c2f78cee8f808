#pragma once

#include "link_chain.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Inverse kinematics of one limb: its hinges and sliding joints, those below the first link, that bring a
// point of its last link to a place, by damped least squares from the angles that it has.
class FootSolver {
 public:
  FootSolver(const FigureModel& model, int link, const Vec3& point);
  const std::vector<int>& joints() const { return joints_; }  // links, that it bends
  Vec3 where(const FigureState& state) const;
  // Changes the limb's angles and rates; `place` (m) moves not. Returns what is missing (m): the place may be
  // out of reach. Ranges are kept.
  double solve(const Vec3& place, FigureState& state);

 private:
  void jacobian(const FigureState& state);
  // The least change of angles that moves the point by `by`, damped.
  void step(const Vec3& by, double damping);

  const FigureModel* model_;
  LinkChain chain_;
  Vec3 point_;
  std::vector<int> joints_;    // links
  std::vector<Vec3> columns_;  // m a rad
  std::vector<double> change_, unit_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

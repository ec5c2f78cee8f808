#pragma once

#include <vector>

#include "softpoint/figure/figure_model.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// A point of a figure with the derivatives of its place, world axes.
struct PointMotion {
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero(), acceleration = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  // of the link, in the world
  Vec3 spin = Vec3::Zero(), spin_rate = Vec3::Zero();
};

// The links between the world and one of them: how a point of that one moves. Plain and for one point; many
// are FigureDynamics' business.
class LinkChain {
 public:
  LinkChain(const FigureModel& model, int link);
  const std::vector<int>& links() const { return links_; }  // from the world on
  // `point`: m, in the last link's frame. `qd` and `qdd` may be null: at rest.
  PointMotion evaluate(const Vec3& point, const double* q, const double* qd, const double* qdd) const;

 private:
  const FigureModel* model_;
  std::vector<int> links_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

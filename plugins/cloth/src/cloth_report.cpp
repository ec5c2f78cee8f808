// What can be read of a cloth after a step.
#include <algorithm>
#include <cmath>

#include "cloth_state.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

std::span<const Vec3> Cloth::contact_forces() const { return state_->contact_forces; }

double Cloth::contact_area() const {
  double sum = 0;
  for (std::size_t v = 0; v < state_->contact_forces.size(); ++v) {
    sum += state_->contact_forces[v].isZero(0) ? 0.0 : state_->point_areas[v];
  }
  return sum;
}

std::span<const BubbleState> Cloth::bubbles() const { return state_->bubbles; }

AirBalance Cloth::air_balance() const {
  const BubbleFinder& finder = state_->finder;
  return {finder.air(), finder.vented(), finder.audit(), finder.initial_air()};
}

StretchState Cloth::stretch() const {
  const auto structural = [](const Spring& spring) {
    return spring.kind == SpringKind::kWarp || spring.kind == SpringKind::kWeft;
  };
  const std::vector<Spring>& springs = state_->wet.springs;
  const bool grid = std::any_of(springs.begin(), springs.end(), structural);
  std::vector<double> strains;
  strains.reserve(springs.size());
  StretchState result;
  for (const Spring& spring : springs) {
    if (spring.rest > 0.0 && (!grid || structural(spring))) {
      const Vec3 along =
          positions_[static_cast<std::size_t>(spring.b)] - positions_[static_cast<std::size_t>(spring.a)];
      strains.push_back(along.norm() / spring.rest - 1.0);
      result.mean += std::abs(strains.back());
    }
  }
  if (strains.empty()) {
    return result;
  }
  result.mean /= static_cast<double>(strains.size());
  const auto at99 = strains.begin() + static_cast<std::ptrdiff_t>(0.99 * double(strains.size() - 1));
  std::nth_element(strains.begin(), at99, strains.end());
  result.p99 = *at99;
  result.largest = *std::max_element(at99, strains.end());
  return result;
}

double Cloth::elastic_energy() const {
  double sum = 0;
  const ClothPattern& wet = state_->wet;
  for (const Spring& spring : wet.springs) {
    const double longer =
        (positions_[static_cast<std::size_t>(spring.b)] - positions_[static_cast<std::size_t>(spring.a)])
            .norm() -
        spring.rest;
    const double factor = longer < 0.0 ? state_->design.fabric.compression_ratio : 1.0;
    sum += 0.5 * factor * spring.stiffness * longer * longer;
  }
  for (const BendElement& bend : wet.bends) {
    Vec3 fold = Vec3::Zero();
    for (int k = 0; k < 4; ++k) {
      fold += bend.weight[k] * positions_[static_cast<std::size_t>(bend.point[k])];
    }
    sum += 0.5 * bend.stiffness * fold.squaredNorm();
  }
  return sum;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

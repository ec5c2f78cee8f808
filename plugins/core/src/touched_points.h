#pragma once

#include <array>
#include <vector>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI {

// The points of one body that contacts and handles touch, and how they answer impulses on one another.
struct TouchedPoints {
  std::vector<int> points;     // vertex indices, ascending
  std::vector<int> local;      // vertex -> index in `points`, -1 elsewhere
  std::vector<double> blocks;  // 3n x 3n column-major, velocity per impulse
  std::vector<int> part;       // of each: which of those that hang together
  // Of each part, its points: from the first of a run to behind its last.
  std::vector<std::vector<std::array<int, 2>>> runs;
  std::vector<Vec3> displacement;  // of each touched point by impulses, m
  std::vector<Vec3> reference;     // the same at the last detection
  std::vector<Vec3> impulses;      // sum per touched point, N s

  // After `blocks` was filled: points that do not answer one another need not be told of one another.
  void find_parts();
  // Velocity of touched point i per impulse on touched point j.
  Mat3 compliance(int i, int j) const;
  // Adds the displacement of all touched points over `dt` by an impulse on touched point `index`.
  void spread(int index, const Vec3& impulse, double dt);
};

}  // namespace softpoint::inline SOFTPOINT_ABI

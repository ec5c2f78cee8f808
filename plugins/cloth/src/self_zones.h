#pragma once

#include <span>
#include <vector>

#include "cloth_solver.h"
#include "self_distance.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Point v[0] against face v[1], v[2], v[3], or edge v[0], v[1] against edge v[2], v[3].
struct SelfPair {
  int v[4] = {0, 0, 0, 0};
  bool edges = false;
  double due = 0;  // m, of the way that points have gone: until then the two cannot touch

  void corners(std::span<const Vec3> positions, Vec3 (&x)[4]) const {
    for (int k = 0; k < 4; ++k) x[k] = positions[static_cast<std::size_t>(v[k])];
  }
};

// A pair that may touch within a small step, as it was at its start.
struct SelfMeeting {
  SelfPair pair;
  Nearest nearest;
  Vec3 normal = Vec3::Zero();  // from the second to the first
  double wanted = 0;           // m, between them at the end
  double thickness = 0;        // m
};

// The last resort against crossing (impact zones, after Provot and Bridson): corners of pairs that would pass
// through each other within a small step are joined and go the way of their centre of mass, joined with more
// until nothing passes through anything. Points alone go as they want.
class SelfZones {
 public:
  explicit SelfZones(std::size_t points) : parents_(points), members_(points) {}

  struct Motion {
    std::span<Vec3> positions;   // m, at the end of the small step; changed
    std::span<Vec3> velocities;  // m/s; changed
    std::span<const double> inverse_masses;
    std::span<const Vec3> before;
    std::span<const PointContacts> contacts;
    double h = 0;
  };
  // Returns how many points go together with others.
  int join(const Motion& motion, std::span<const SelfMeeting> meetings);

 private:
  bool crosses(const SelfMeeting& meeting, const Motion& motion) const;
  bool unite(const SelfPair& pair);
  void move(const Motion& motion);

  std::vector<int> parents_;
  struct Member {
    int root, point;
  };
  std::vector<Member> members_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

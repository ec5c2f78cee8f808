#pragma once

#include <span>
#include <vector>

#include "cloth_solver.h"
#include "self_patches.h"
#include "self_zones.h"
#include "softpoint/cloth/cloth.h"
#include "softpoint/core/state_archive.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Keeps a cloth from passing through itself: points and faces, edges and edges, at the distance of the
// cloth's thickness, with friction. Works on positions and velocities after each small step, from where it
// began, which is free of intersections: near pairs are pushed apart with momentum kept; whatever would still
// pass through something goes together (SelfZones). So nothing ever crosses. Near pairs are kept until points
// have moved so far that others may have come near.
class SelfContactPass {
 public:
  SelfContactPass(const ClothPattern& pattern, double thickness);

  // What a small step left: to be corrected in place.
  struct Points {
    std::span<Vec3> positions;                // m
    std::span<Vec3> velocities;               // m/s
    std::span<const double> inverse_masses;   // 1/kg; 0 for what a hand holds
    std::span<const Vec3> before;             // m, where the small step began
    std::span<const PointContacts> contacts;  // planes, where a point touches one
    double h = 0;                             // s, of the small step
  };
  struct Counts {
    int searches = 0;     // for near pairs
    int patch_pairs = 0;  // looked at in the last search
    int pairs = 0;        // near each other
    int contacts = 0;     // corrections made
    int zones = 0;        // points that had to go together with others
    int dropped = 0;      // pairs of faces left out, beyond what a frame may cost
  };

  // At the start of a frame: whether cloth may meet cloth in it at all. What moves much slower than the room
  // that the last search left is only looked at again in the next frame.
  bool begin_frame(std::span<const Vec3> positions, std::span<const Vec3> velocities, double dt);
  // After a small step of a frame that was to be left out: whether points have moved too far for that.
  bool outrun(std::span<const Vec3> positions) const;
  // After a small step. Returns whether anything has changed.
  bool correct(const Points& points, double friction);
  // Points were put elsewhere: nothing is known of what is near what.
  void forget();
  void archive(StateArchive& archive, int points);

  Counts counts;

 private:
  using Pair = SelfPair;

  static double spread(std::span<const Vec3> to, std::span<const Vec3> from);
  void search(std::span<const Vec3> positions);
  void consider(int face, int other, std::span<const Vec3> positions);
  void activate(std::span<const Vec3> before, double way);
  static void slow_down(const Points& points, double most);
  bool push_apart(const Points& points, double friction);
  bool push_apart(const SelfMeeting& meeting, const Points& points, double friction);

  SelfPatches patches_;
  SelfZones zones_;
  double thickness_;
  double room_;       // m, points move half of it before pairs are looked for anew
  double reach_ = 0;  // m, of the search
  bool known_ = false;
  std::size_t most_pairs_ = 0;
  int most_face_pairs_ = 0;  // that the search at work may still look at
  double travel_ = 0;        // m, sum of how far two points can have come nearer each other
  std::vector<Vec3> searched_at_, wanted_;
  std::vector<Pair> pairs_;
  std::vector<SelfMeeting> meetings_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

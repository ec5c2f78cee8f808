#pragma once

#include <span>
#include <vector>

#include "cloth_solver.h"
#include "self_patches.h"
#include "softpoint/cloth/cloth.h"
#include "softpoint/core/state_archive.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Keeps a cloth from passing through itself: points stay on the side of faces they came from, and edges on
// that of edges, at the distance of the cloth's thickness, with friction. Near pairs are kept until points
// have moved so far that others may have come near. Works on positions and velocities after each small step,
// and keeps momentum: what one side gains the other loses.
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
    const ClothSolver* solver = nullptr;      // says which do
  };
  struct Counts {
    int searches = 0;     // for near pairs
    int patch_pairs = 0;  // looked at in the last search
    int pairs = 0;        // near each other
    int contacts = 0;     // corrections made
    int dropped = 0;      // pairs of faces left out, beyond what a frame may cost
  };

  // At the start of a frame: whether cloth may meet cloth in it at all. What moves much slower than the room
  // that the last search left is only looked at again in the next frame.
  bool begin_frame(std::span<const Vec3> positions, std::span<const Vec3> velocities, double dt);
  // After a small step. Returns whether anything has changed.
  bool correct(const Points& points, double friction);
  // Points were put elsewhere: nothing is known of sides.
  void forget();
  void archive(StateArchive& archive, int points);

  Counts counts;

 private:
  // Point a against face b, c, d, or edge a, b against edge c, d.
  struct Pair {
    int v[4] = {0, 0, 0, 0};
    bool edges = false;
    signed char side = 0;  // of the first against the second; 0: not within each other's reach yet
    double due = 0;        // m, of `travel_`: until then the two cannot touch
  };
  struct Gap {
    double weights[4];  // gap = sum weights x . normal
    Vec3 normal = Vec3::Zero();
    double height = 0;  // m, along the normal, signed
    bool within = false;
  };

  static double spread(std::span<const Vec3> to, std::span<const Vec3> from);
  void search(std::span<const Vec3> positions);
  void consider(int face, int other, std::span<const Vec3> positions);
  static Gap gap_of(const Pair& pair, std::span<const Vec3> positions);
  static void choose_side(Pair& pair, const Gap& gap, const Points& points);
  bool separate(const Pair& pair, const Gap& gap, const Points& points, double friction);
  static bool before_in_list(const Pair& a, const Pair& b);

  SelfPatches patches_;
  double thickness_;
  double room_;       // m, points move half of it before pairs are looked for anew
  double reach_ = 0;  // m, of the search
  bool known_ = false;
  int most_face_pairs_ = 0;  // that the search at work may still look at
  double travel_ = 0;        // m, sum of how far two points can have come nearer each other
  std::vector<Vec3> searched_at_;
  std::vector<Pair> pairs_, crossed_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

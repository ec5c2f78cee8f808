#pragma once

#include <span>
#include <vector>

#include "air_leak.h"
#include "air_pocket.h"
#include "air_topology.h"
#include "softpoint/cloth/air.h"
#include "softpoint/core/state_archive.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Where a cloth is at the start of a frame. One entry a point; lengths in metres, all in one frame of
// coordinates whose origin is near the cloth. Feet are the nearest points of colliders, normals theirs, out
// of the collider. Gaps are 0 in contact (thickness taken off) and infinite where no collider is within
// reach.
struct AirFrame {
  std::span<const Vec3> positions;
  std::span<const Vec3> feet;
  std::span<const Vec3> normals;
  std::span<const double> gaps;
};

// What a bubble is beyond what the stepper needs of it.
struct Bubble {
  int faces = 0;
  double area = 0;        // m2, of its faces at rest
  double volume = 0;      // m3, when it was found
  double open_weave = 0;  // m3/(s Pa), conductance of dry pores
  double wet_weave = 0;   // m3/(s Pa), conductance that pores full of water have once they burst
  double facing = 0;      // m2, of its faces as seen along the normals of the collider
  int rim_begin = 0;      // its quads within rims(), up to that of the next bubble
  bool closed = false;    // by its own faces
  bool thin = false;      // its air rests on the contact patch
  bool folded = false;    // its volume is negative
  bool touches = false;   // some point of it does, while they are found
  bool touched = false;   // some point of it has, at some time
  bool unsealed =
      false;           // its rim has not closed since it came to be, or came off: open, whatever `vent` says
  bool patch = false;  // no bubble, but a contact patch that suction holds
};

// What the search did and left out, since the cloth was made.
struct AirCounts {
  long long frames = 0;       // searched
  long long skipped_off = 0;  // frames without air: switched off
  long long skipped_dry = 0;  // frames without air: nothing is wet or closed
  long long labels_kept = 0;  // frames in which no touch changed, so that the bubbles are the same
  long long open = 0;         // bubbles that need no pressure, summed over frames
  long long folded = 0;       // bubbles of negative volume, summed over frames
  long long born = 0;         // bubbles without a predecessor
  long long merged = 0;       // bubbles that went up in another
  long long split = 0;        // bubbles that came out of another beyond the first
  long long parked = 0;       // bubbles whose air went to rest on a contact patch
};

// The bubbles of a cloth, found anew each frame; their air is conserved to rounding. Nothing is allocated
// after construction.
class BubbleFinder {
 public:
  // Throws Error for bad settings.
  BubbleFinder(AirTopology topology, const AirSettings& settings);

  // Saturation of each point, 0 to 1. Everything is dry until this is called.
  void set_saturation(std::span<const double> saturation);
  // Takes effect with the next frame. Throws Error for bad settings.
  void set_settings(const AirSettings& settings);
  const AirSettings& settings() const { return settings_; }

  // Begins a frame: the bubbles, their air and what closes them. Returns whether there is any pressure to
  // solve.
  bool find(const AirFrame& frame);
  // Ends it: limits of suction, leak through weave and rim. `volumes` (m3): of each pocket, as stepped.
  void exchange(double dt, std::span<const double> volumes);
  // Adds to `forces` (N), one a point, what each point's foot feels of its bubble at the gauge pressures
  // given (Pa, one a pocket): their sum is opposite to that of gauge * dV/dx over the points of the cloth.
  void add_foot_forces(const AirFrame& frame, std::span<const double> gauges, std::span<Vec3> forces) const;
  // Volume of a pocket, m3, as the stepper has it.
  double volume(int pocket, std::span<const Vec3> positions) const;

  std::span<const int> face_pockets() const { return face_pocket_; }  // -1: none
  // Bubbles first, then contact patches.
  std::span<const AirPocket> pockets() const { return pockets_; }
  std::span<const Bubble> bubbles() const { return bubbles_; }
  std::span<const RimQuad> rims() const { return rims_; }
  // N, one a point: what its film presses it on with, along the collider's normal, while it touches.
  std::span<const double> adhesion() const { return adhesion_; }
  std::span<const char> touching() const { return touching_; }
  const AirCounts& counts() const { return counts_; }
  const AirTopology& topology() const { return topology_; }

  double air() const;     // J, in all bubbles and at rest on patches
  double vented() const;  // J, what left for the atmosphere less what came from it
  double audit() const;   // J, what air() + vented() differs by from the air at the start
  double initial_air() const { return total_; }  // J

  // For snapshots: all but settings, counts and what find() measures anew.
  void archive(StateArchive& archive);

 private:
  struct Rim {
    int edge;
    int face;       // the one of the two that belongs to the bubble
    bool reversed;  // the face runs along the edge from b to a
    bool free;      // nothing but the film under it keeps the air in
    double gap;     // m
  };

  bool update_touch(std::span<const double> gaps);
  void group();
  void number_pockets();
  void join_by_points(int face);
  void mark_points();
  void add_ring();
  void add_patches();
  // Patches are no bubbles: -1.
  int bubble_of(int face) const { return face_pocket_[face] < bubble_count_ ? face_pocket_[face] : -1; }
  int old_bubble_of(std::size_t face) const {
    return old_face_pocket_[face] < old_bubble_count_ ? old_face_pocket_[face] : -1;
  }
  void measure_faces(const AirFrame& frame);
  double air_before_moving() const;
  void move_air();
  void first_air();
  void take_parked();
  void count_changes();
  void collect_rims();
  void measure_rims(std::span<const double> gaps);
  void measure_pockets(const AirFrame& frame);
  void find_loose();
  void close_pockets();
  void close_patches(std::span<const Vec3> positions);
  void adhere(std::span<const double> gaps);
  void drop_all();
  void vent(int pocket, double air);
  int rim_end(int pocket) const;
  void find_wet();
  bool airy(int face) const { return airy_[face] != 0; }
  bool wholly_touching(const AirTopology::Edge& edge) const { return touching_[edge.a] && touching_[edge.b]; }

  static constexpr int kNone = -1, kShared = -2;

  AirTopology topology_;
  AirSettings settings_;
  bool fresh_ = true;        // there are no bubbles to go on from
  bool repaint_ = false;     // saturation or settings have changed
  bool started_ = false;     // there have been some
  bool wet_ = false;         // some point is
  bool has_closed_ = false;  // some face belongs to a closed shell
  std::vector<double> saturation_;
  std::vector<double> dry_pores_;  // share of each face's pores without water
  std::vector<char> touching_;
  std::vector<int> touch_frames_;
  std::vector<char> airy_;       // per face: has a point that does not touch, all within reach
  std::vector<char> reachable_;  // per face
  std::vector<int> face_pocket_, old_face_pocket_, parents_, point_pocket_, point_face_;
  std::vector<double> face_volume_, parked_;
  std::vector<AirPocket> pockets_, old_pockets_;
  int bubble_count_ = 0, old_bubble_count_ = 0;  // what comes after them are patches
  std::vector<Bubble> bubbles_;
  std::vector<double> old_weight_, old_area_;
  struct Seal {
    bool touched, unsealed;
  };
  std::vector<Seal> old_seals_;
  std::vector<int> old_children_, seen_by_, face_order_, order_cursor_;
  std::vector<RimQuad> rims_;
  std::vector<Rim> rim_list_, rim_unsorted_;
  std::vector<int> rim_cursor_;
  std::vector<char> border_point_;
  std::vector<double> adhesion_;
  std::vector<Opening> openings_;
  double total_ = 0;
  double vented_ = 0, vented_rest_ = 0;  // a compensated sum
  AirCounts counts_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

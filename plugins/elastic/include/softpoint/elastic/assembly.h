#pragma once

#include <memory>
#include <span>
#include <vector>

#include "softpoint/core/vec.h"
#include "softpoint/elastic/assembly_design.h"
#include "softpoint/elastic/assembly_settings.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// What the end of a part is held by.
enum class Hold {
  kNothing,
  kPoint,    // the end of the bone; the joining surface turns about it
  kSurface,  // every vertex of the joining surface
};

// A vertex of a segment's mesh.
struct SegmentVertex {
  int part = 0;
  int segment = 0;  // of the part
  int vertex = 0;   // of the segment's mesh
};

// What one solve cost, did and left out; sums over all groups of parts that hang together.
struct AssemblyReport {
  int groups = 0;            // in the assembly
  int groups_solved = 0;     // nothing had moved in the others
  int segments = 0;          // in the assembly
  int segments_skinned = 0;  // whose skin was computed: a joint of theirs had moved
  long long products = 0;    // segments multiplied while solving
  int iterations = 0;        // steps taken
  int evaluations = 0;       // of energy and forces
  int ik_sweeps = 0;         // of cyclic coordinate descent
  double residual = 0;       // largest imbalance of a group's joints over their forces
  // rad, of a segment against its neighbour, over that at rest: from about 1 on strains are large, and near
  // pi (a twist of half a turn within one segment) the shape may be another than the one meant.
  double largest_turn = 0;
  bool balanced = true;                        // every residual is within the tolerance
  double solve_seconds = 0, skin_seconds = 0;  // wall time
};

// Joining surfaces after a solve.
struct JointQuality {
  double gap = 0;  // m, largest distance of paired vertices: 0, they share their points
  double kink =
      0;  // rad, largest angle between skin normals across a joining surface's rim, over that at rest
};

// Statics and slow motion of joined elastic parts: displacements of the ends in, shape and forces out. Parts
// have no mass of their own here (see Character for what moves by itself). Large rotations are exact segment
// by segment; strains within a segment are linear. Not thread-safe; equal calls give equal bits.
class SOFTPOINT_API Assembly {
 public:
  // The whole rest pose turned by `rotation` and moved by `origin`. Throws Error as check() does.
  explicit Assembly(const AssemblyDesign& design, const AssemblySettings& settings = {},
                    const Vec3& origin = Vec3::Zero(), const Mat3& rotation = Mat3::Identity());
  ~Assembly();
  Assembly(Assembly&&) noexcept;
  Assembly& operator=(Assembly&&) noexcept;

  const AssemblyDesign& design() const;
  const AssemblySettings& settings() const;
  // Throws Error for what is out of range; precision and instruction set cannot be changed any more.
  void set_settings(const AssemblySettings& settings);

  // Holding an end factors the joints' stiffness anew: not for every frame. The end stays where it is until
  // it is moved. Throws Error for a part out of range or an end joined to a patch.
  void hold(const PartEnd& end, Hold what);
  Hold held(const PartEnd& end) const;
  // Where a held end is to be from the next solve on: the end of its bone (m), and for Hold::kSurface the
  // turn of its joining surface from the rest pose; without one it keeps its turn. Throws Error for an end
  // that is not held, or beyond kMaxPosition.
  void move(const PartEnd& end, const Vec3& position);
  void move(const PartEnd& end, const Vec3& position, const Mat3& turn);
  // Acceleration (m/s2) that weighs on all segments.
  void set_gravity(const Vec3& gravity);
  // Force (N, world) on a vertex of the skin, that of a joining surface included; replaces that given before.
  void push(const SegmentVertex& vertex, const Vec3& force);
  void clear_pushes();

  // Brings the joints into balance within the settings' budget, then the skin. Does not allocate, throw or
  // log. Groups of parts for which nothing has changed cost nothing.
  void solve();
  const AssemblyReport& report() const;  // of the last solve

  // Force (N) and moment about the end of the bone (N m) by which its holder acts on an end.
  Vec3 force(const PartEnd& end) const;
  Vec3 moment(const PartEnd& end) const;
  // Joints X_0 to X_N of a part's bone, m.
  std::vector<Vec3> bone(int part) const;
  double energy() const;          // J, of segments and bones, pushes and gravity: what is least in balance
  double elastic_energy() const;  // J, of segments alone, at the last solve

  // The skin: vertices (m), those seen from outside first, and the triangles between them that are seen.
  // Spans stay valid; contents change with each solve.
  std::span<const Vec3> points() const;
  std::span<const Triangle> faces() const;
  int visible_points() const;
  // Index in points() of a segment's vertex. Throws Error for one out of range.
  int point_of(const SegmentVertex& vertex) const;
  double volume() const;  // m3, of all segments as they are
  JointQuality quality() const;

 private:
  friend class Character;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

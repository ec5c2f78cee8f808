#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "softpoint/core/triangle_mesh.h"
#include "softpoint/figure/figure_dynamics.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// The shape of a link, or a part of it: all points within `radius` of a segment, in the link's frame.
struct LinkCapsule {
  int link = 0;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  // m
  double radius = 0.05;                         // m
};

// What a figure can touch.
struct Obstacle {
  enum class Kind {
    kHalfSpace,  // below the plane z = 0 of its frame
    kBox,        // of edges `size`, about its origin
    kCapsule,    // along z of its frame, from -length/2 to length/2; length 0 is a sphere
    kMesh        // triangles without an inside
  };
  Kind kind = Kind::kHalfSpace;
  Vec3 position = Vec3::Zero();         // m
  Mat3 orientation = Mat3::Identity();  // its axes in the world
  Vec3 size = Vec3::Ones();             // m
  double radius = 0.1, length = 0;      // m
  TriangleMesh mesh = {};
};
// The half-space under `point`, `normal` being its upward side.
SOFTPOINT_API Obstacle half_space(const Vec3& point, const Vec3& normal);

// A place where a link's capsule comes near something.
struct Touch {
  int capsule = 0;
  int obstacle = -1;            // or
  int other = -1;               // another capsule
  double gap = 0;               // m, negative in penetration
  Vec3 point = Vec3::Zero();    // m, world, on the capsule
  Vec3 normal = Vec3::UnitZ();  // from the obstacle (the other capsule) to this one
};

// What is near a figure. The broad phase is FCL's tree of boxes; pairs whose boxes overlap go to the narrow
// phase, closed forms of capsules against half-spaces, boxes, capsules and triangles; no others. Allocates
// nothing after the first few queries.
class SOFTPOINT_API FigureCollision {
 public:
  // `pairs`: links that may not run through each other. Throws Error naming the field for links that do not
  // exist, sizes out of range, a frame that is none.
  FigureCollision(const FigureModel& model, std::vector<LinkCapsule> capsules,
                  std::vector<Obstacle> obstacles, std::vector<std::pair<int, int>> pairs = {});
  ~FigureCollision();
  FigureCollision(FigureCollision&&) noexcept;
  FigureCollision& operator=(FigureCollision&&) noexcept;

  const std::vector<LinkCapsule>& capsules() const;
  const std::vector<Obstacle>& obstacles() const;
  void move_obstacle(int index, const Vec3& position, const Mat3& orientation);

  // Puts the capsules where FigureDynamics::place() has the links.
  void place(const FigureDynamics& placed);
  // Moves all of them (m).
  void shift(const Vec3& by);

  // All touches with gaps of at most `reach` (m), 0 to 10; valid until the next call. A capsule lying on a
  // plane or a box has one at each end.
  std::span<const Touch> near(double reach);

  struct Counts {
    long long queries = 0;
    long long overlapping = 0;  // pairs whose boxes overlap, half-spaces included
    long long narrow = 0;       // tests of two shapes
  };
  const Counts& counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <limits>
#include <unordered_map>
#include <vector>

#include "bullet_math.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Distance (m, negative inside) and outward unit normal of a shape's surface, in the shape's frame.
struct SurfaceDistance {
  double distance = 0;
  Vec3 normal = Vec3::UnitY();
};

// An edge of a rigid shape: from a to b, with the unit directions that lead from the edge into its two faces.
struct ShapeEdge {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  Vec3 into_first = Vec3::Zero();
  Vec3 into_second = Vec3::Zero();
};

// A triangle of a polyhedron's face, in the plane normal . x = offset.
struct ShapeFacet {
  Vec3 a, b, c;
  Vec3 normal;
  double offset = 0;
};

// What contact needs of a collision shape, in its local frame and scale.
struct ColliderShape {
  enum class Kind { plane, sphere, box, capsule, convex, unsupported };

  Kind kind = Kind::unsupported;
  Vec3 half = Vec3::Zero();           // box: half extents; capsule: half height along `axis`
  double radius = 0;                  // sphere, capsule
  int axis = 1;                       // capsule
  Vec3 plane_normal = Vec3::UnitY();  // plane: normal . x = plane_offset
  double plane_offset = 0;
  const btConvexShape* convex = nullptr;
  std::vector<ShapeFacet> facets;  // convex polyhedra, without margin

  // Corners and edges of a box; round shapes and other convex ones meet the skin face by face instead.
  std::vector<Vec3> corners;
  std::vector<std::vector<Vec3>> corner_edges;  // per corner, unit directions of its edges away from it
  std::vector<ShapeEdge> edges;

  Vec3 bounds_min = Vec3::Zero();  // local axis-aligned bounds (unused for planes)
  Vec3 bounds_max = Vec3::Zero();
  double thinnest = 0;  // m, smallest distance across

  SurfaceDistance distance(const Vec3& local) const;
  // Conservative: farther than `reach` from the shape for certain.
  bool beyond(const Vec3& local, double reach) const;
  // Shortest line between the shape's core and a triangle (both in the shape's frame), for round and other
  // convex shapes: the shape is its core thickened by core_radius(). False where the two overlap.
  struct CoreDistance {
    double distance = 0;  // m, from core to triangle, > 0
    Vec3 on_core = Vec3::Zero();
    Vec3 on_triangle = Vec3::Zero();
  };
  bool core_distance(const Vec3& a, const Vec3& b, const Vec3& c, CoreDistance& result) const;
  double core_radius() const;
  bool meets_faces() const { return kind == Kind::sphere || kind == Kind::capsule || kind == Kind::convex; }
};

// Builds and keeps ColliderShapes by address; rebuilds one whose dimensions changed and forgets those long
// out of use. References stay valid until the next begin_substep().
class ColliderShapes {
 public:
  void begin_substep();
  const ColliderShape& get(const btCollisionShape& shape);

 private:
  struct Entry {
    ColliderShape shape;
    double fingerprint[9] = {};
    long long last_used = 0;
  };
  long long substep_ = 0;
  std::unordered_map<const btCollisionShape*, Entry> entries_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI

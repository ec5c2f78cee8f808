#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "box_tree.h"
#include "bullet_math.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Distance (m, negative inside) and outward unit normal of a shape's surface, in the shape's frame.
struct SurfaceDistance {
  double distance = 0;
  Vec3 normal = Vec3::UnitY();
};

// An edge of a rigid shape: from a to b, with the unit directions that lead from the edge into its two faces
// (the second is zero on the rim of an open mesh).
struct ShapeEdge {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  Vec3 into_first = Vec3::Zero();
  Vec3 into_second = Vec3::Zero();
};

// A triangle of a polyhedron or mesh, in the plane normal . x = offset.
struct ShapeFacet {
  Vec3 a, b, c;
  Vec3 normal;
  double offset = 0;
};

// What contact needs of a collision shape, in its local frame and scale. Shapes are taken as they are drawn:
// the margin that Bullet keeps round hulls, cones and meshes is no part of them.
struct ColliderShape {
  // `polyhedron` is a convex one with facets; `round` any other convex shape, by Bullet's GJK; `mesh` a patch
  // of triangles without an inside.
  enum class Kind { plane, sphere, box, capsule, cylinder, cone, polyhedron, round, mesh, unsupported };

  Kind kind = Kind::unsupported;
  Vec3 half = Vec3::Zero();           // box: half extents; others: half height along `axis`
  double radius = 0;                  // sphere, capsule, cylinder, base of a cone
  int axis = 1;                       // capsule, cylinder, cone (towards its tip)
  Vec3 plane_normal = Vec3::UnitY();  // plane: normal . x = plane_offset
  double plane_offset = 0;
  const btConvexShape* convex = nullptr;  // round
  std::vector<ShapeFacet> facets;         // polyhedron, mesh

  // Corners and edges that can press into a skin; round shapes meet it face by face instead.
  std::vector<Vec3> corners;
  std::vector<Vec3> corner_edges;  // unit directions of the corners' edges away from them, corner by corner
  std::vector<int> corner_edges_from;  // per corner, and the end: where its directions begin
  std::vector<ShapeEdge> edges;
  BoxTree corner_tree, edge_tree, facet_tree;

  Vec3 bounds_min = Vec3::Zero();  // local axis-aligned bounds (unused for planes)
  Vec3 bounds_max = Vec3::Zero();
  double thinnest = 0;  // m, smallest distance across

  std::span<const Vec3> edges_of_corner(int corner) const {
    const auto c = static_cast<std::size_t>(corner);
    const auto from = static_cast<std::size_t>(corner_edges_from[c]);
    return {corner_edges.data() + from, static_cast<std::size_t>(corner_edges_from[c + 1]) - from};
  }
  SurfaceDistance distance(const Vec3& local) const;
  // Conservative: farther than `reach` from the shape for certain.
  bool beyond(const Vec3& local, double reach) const;
  // Shortest line between the shape's core and a triangle (both in the shape's frame), for spheres, capsules
  // and `round` shapes: the shape is its core thickened by core_radius(). False where the two overlap.
  struct CoreDistance {
    double distance = 0;  // m, from core to triangle, > 0
    Vec3 on_core = Vec3::Zero();
    Vec3 on_triangle = Vec3::Zero();
  };
  bool core_distance(const Vec3& a, const Vec3& b, const Vec3& c, CoreDistance& result) const;
  double core_radius() const;
  bool meets_faces() const { return kind == Kind::sphere || kind == Kind::capsule || kind == Kind::round; }
};

// Whether a shape is made of triangles without an inside (mesh, height field): such shapes are taken patch by
// patch, see MeshPatches.
bool is_mesh(const btCollisionShape& shape);

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

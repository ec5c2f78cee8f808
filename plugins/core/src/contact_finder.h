#pragma once

#include <vector>

#include "contact.h"
#include "feature_source.h"
#include "skin.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Features up to this many margins beyond the margin become candidates: other contacts may push them in.
inline constexpr double kSlackMargins = 3.0;
// Below this depth (m) the nearest surface point at the end of the step may be on the wrong side, so the path
// of the step is followed to the point of entry instead.
inline constexpr double kTrustedDepth = 5e-3;
// Normals whose cosine is below this belong to different sides of a shape.
inline constexpr double kSameSide = 0.7;

// Finds the contacts of one deformable in the configuration that the end of the step would have, so that what
// the solver separates stays separated after Bullet has integrated.
class ContactFinder {
 public:
  // Starts a pass; `first` in the first one of a substep, which also follows features along their way.
  void begin_pass(int body_index, const Deformable& body, double margin, bool first);
  // The skin, brought up to date when first asked for in a pass.
  const Skin& skin();

  // Vertices of the skin against a shape with a distance of its own.
  void find_vertices(const ShapeInstance& shape, const RigidState& rigid, ContactTable& contacts);
  // Vertices of the skin against triangles without an inside.
  void find_vertices_on_mesh(const ShapeInstance& shape, const RigidState& rigid, ContactTable& contacts);
  // Faces of the skin against a round shape.
  void find_faces(const ShapeInstance& shape, const RigidState& rigid, ContactTable& contacts);
  // Corners and edges, of shapes or of another skin, against the faces and edges of this one.
  void find_corners(const FeatureSource& source, const RigidState& rigid, ContactTable& contacts);
  void find_edges(const FeatureSource& source, const RigidState& rigid, ContactTable& contacts);

  // Where the body is now says nothing of where it was.
  void forget_meshes() { mesh_memories_.clear(); }

  // A contact of an earlier pass of this substep that detection did not find again: measured anew on the
  // same features, so that what one pass separated does not fall back in the next. False when the features
  // have left each other.
  bool refresh_face(const ShapeInstance& shape, const RigidState& rigid, Contact& contact) const;
  bool refresh_corner(const FeatureSource& source, const RigidState& rigid, Contact& contact);
  // On the plane it had: through `other_point` (m, at the end of the step), with a fixed normal.
  void refresh_on_plane(const Vec3& other_point, Contact& contact) const;

 private:
  struct MeshTouch {              // a vertex of the skin at a triangle
    Vec3 normal = Vec3::UnitY();  // shape frame, towards the skin
    double gap = 0;               // m beyond the margin
    double distance = 0;          // m, without sign
    double crossed_at = 2.0;      // part of the step after which it was crossed; 2 when it was not
    bool interior = false;        // within the triangle, or crossed
    bool way_out = false;         // of a vertex on the wrong side
  };

  // On which side of a mesh the vertices were in the last substep.
  struct MeshMemory {
    const btCollisionObject* object = nullptr;
    int child = 0;
    long long substep = -1;          // of the last use
    bool fresh = true;               // there was none
    std::vector<signed char> sides;  // front 1, back -1, 0 unknown
  };

  MeshMemory& mesh_memory(const btCollisionObject* object, int child);
  signed char side_of_mesh(const std::vector<ShapeFacet>& facets, const Vec3& from, const Vec3& to,
                           const Vec3& skin_normal, bool fresh, signed char known) const;
  void touch_mesh(const std::vector<ShapeFacet>& facets, const Vec3& from, const Vec3& to, double side,
                  std::vector<MeshTouch>& touches) const;
  bool free_slot(int zone, const Vec3& point, double gap, Contact& name, ContactTable& contacts) const;
  bool sample_face(const Triangle& face, const ColliderShape& shape, const Pose& pose, Vec3& weights,
                   Vec3& normal, double& distance) const;
  void place_on_vertex(int vertex, const ShapeInstance& shape, const RigidState& rigid,
                       Contact& contact) const;
  void place_on_face(int face, const Vec3& weights, const RigidState& rigid, Contact& contact) const;
  Vec3 skin_point(const Contact& contact) const;
  Contact identity(const ShapeInstance& shape, const RigidState& rigid, ContactKind kind) const;

  int body_index_ = 0;
  const Deformable* body_ = nullptr;
  double margin_ = 0;
  double reach_ = 0;  // m, candidates within it
  bool first_ = true;
  Skin skin_;
  std::vector<int> features_;       // scratch
  std::vector<MeshTouch> touches_;  // scratch
  std::vector<MeshMemory> mesh_memories_;
  long long substep_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI

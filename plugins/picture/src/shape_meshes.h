#pragma once

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <array>
#include <cstdint>
#include <map>
#include <unordered_map>

#include "softpoint/core/triangle_mesh.h"
#include "softpoint/picture/renderer.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// A mesh of the renderer and how to stretch it into the shape's own frame; mesh -1: nothing to draw.
struct ShapeMesh {
  int mesh = -1;
  Mat3 stretch = Mat3::Identity();
  bool open_surface = false;  // seen from both sides
};

// The meshes of collision shapes other than planes and compounds. Boxes, spheres, cylinders and cones share
// one mesh each, capsules one for every ratio of length to radius, all others have their own.
class ShapeMeshes {
 public:
  explicit ShapeMeshes(Renderer& renderer) : renderer_(renderer) {}
  ShapeMeshes(const ShapeMeshes&) = delete;
  ShapeMeshes& operator=(const ShapeMeshes&) = delete;
  ~ShapeMeshes();

  ShapeMesh find(const btCollisionShape& shape);
  // Counts one more frame; now and then drops what has not been asked for during the last hundred or more.
  void end_frame();

  int tessellated() const { return tessellated_; }  // since the beginning
  int kept() const { return static_cast<int>(capsules_.size() + own_.size()); }

 private:
  // What must not change for a tessellation to stay valid (the address alone may have been reused).
  struct Signature {
    int type = 0;
    std::array<btScalar, 10> numbers{};  // scaling, margin, bounds
    bool operator==(const Signature&) const = default;
  };
  struct Own {
    Signature signature;
    int mesh = -1;
    bool open_surface = false;
    std::uint64_t used = 0;
  };
  struct Capsule {
    int mesh = -1;
    std::uint64_t used = 0;
  };
  enum Unit { kBox, kSphere, kCylinder, kCone, kUnitCount };

  static Signature sign(const btCollisionShape& shape);
  int unit(Unit which);
  int capsule_mesh(double half_length_over_radius);
  ShapeMesh own_mesh(const btCollisionShape& shape);
  int add(const TriangleMesh& mesh);

  Renderer& renderer_;
  std::array<int, kUnitCount> units_ = {-1, -1, -1, -1};
  std::map<double, Capsule> capsules_;
  std::unordered_map<const btCollisionShape*, Own> own_;
  std::uint64_t frame_ = 0;
  int tessellated_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

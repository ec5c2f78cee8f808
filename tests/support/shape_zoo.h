#pragma once

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btConvexTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "support/triangle_surface.h"
#include "support/worlds.h"

// Every kind of thing that an elastic body can touch, as ground and as something free.
namespace softpoint {

enum class Zoo {
  plane,
  box,
  sphere,
  capsule,
  cylinder,
  cone,
  compound,
  hull,
  triangle_mesh,
  scaled_mesh,
  height_field,
  gimpact,
  convex_mesh,
  deformable
};

inline const std::vector<Zoo>& whole_zoo() {
  static const std::vector<Zoo> all = {Zoo::plane,         Zoo::box,         Zoo::sphere,       Zoo::capsule,
                                       Zoo::cylinder,      Zoo::cone,        Zoo::compound,     Zoo::hull,
                                       Zoo::triangle_mesh, Zoo::scaled_mesh, Zoo::height_field, Zoo::gimpact,
                                       Zoo::convex_mesh,   Zoo::deformable};
  return all;
}

inline std::string name_of(Zoo kind) {
  static const char* const names[] = {"Plane",       "Box",      "Sphere",     "Capsule",   "Cylinder",
                                      "Cone",        "Compound", "Hull",       "Mesh",      "ScaledMesh",
                                      "HeightField", "GImpact",  "ConvexMesh", "Deformable"};
  return names[static_cast<int>(kind)];
}

// Planes, plain and scaled meshes and height fields stand still in Bullet.
inline bool may_move(Zoo kind) {
  return kind != Zoo::plane && kind != Zoo::triangle_mesh && kind != Zoo::scaled_mesh &&
         kind != Zoo::height_field;
}
// Spheres and capsules have no flat side to be a slope.
inline bool has_flat_side(Zoo kind) { return kind != Zoo::sphere && kind != Zoo::capsule; }

// Something rigid that is touched: its object and, where it is made of triangles, those.
struct ZooThing {
  btRigidBody* object = nullptr;
  const TriangleSurface* surface = nullptr;

  // Deepest vertex of the skin in it or corner of it in the skin (m, > 0 inside).
  double depth(const Surface& skin) const {
    const btTransform& placed = object->getWorldTransform();
    if (surface != nullptr) {
      return std::max(skin_depth(skin, *surface, placed), corner_depth(skin, *surface, placed));
    }
    return std::max(skin_depth(skin, *object), corner_depth(skin, *object));
  }
};

// What the grounds look like from above: `bumpy` has edges, tips and spikes to fall on, `rolling` is smooth
// and `flat` level where the kind allows; tops are near y = 0.
enum class Ground { bumpy, rolling, flat };

// Makes shapes and keeps the data they refer to; declare it before the world.
class ShapeZoo {
 public:
  // Static, about the origin.
  ZooThing ground(TestWorld& world, Zoo kind, Ground look) {
    const bool bumpy = look == Ground::bumpy;
    const auto at = [&](btCollisionShape* shape, double y, const btQuaternion& turned = upright()) {
      return ZooThing{&world.add(shape, 0, Vec3(0, y, 0), turned), nullptr};
    };
    const btQuaternion askew = bumpy ? btQuaternion(btVector3(0, 1, 0), btScalar(0.3)) : upright();
    switch (kind) {
      case Zoo::plane:
        return {&world.add_floor(), nullptr};
      case Zoo::box:
        return bumpy ? at(new btBoxShape(to_bt(Vec3(0.2, 0.15, 0.2))), -0.15, askew)
                     : at(new btBoxShape(to_bt(Vec3(2, 0.2, 0.6))), -0.2);
      case Zoo::sphere: {
        const double radius = bumpy ? 0.2 : 2.0;
        return at(new btSphereShape(btScalar(radius)), -radius);
      }
      case Zoo::capsule: {
        const double radius = bumpy ? 0.12 : 1.0;
        return at(new btCapsuleShapeX(btScalar(radius), btScalar(bumpy ? 0.3 : 3.0)), -radius, askew);
      }
      case Zoo::cylinder:
        return bumpy ? at(new btCylinderShape(to_bt(Vec3(0.2, 0.15, 0.2))), -0.15)
                     : at(new btCylinderShape(to_bt(Vec3(2, 0.2, 2))), -0.2);
      case Zoo::cone:  // on its foot, or on its tip with the foot up
        return bumpy ? at(new btConeShape(btScalar(0.25), btScalar(0.35)), -0.175)
                     : at(new btConeShape(2, 1), -0.5, btQuaternion(btVector3(1, 0, 0), SIMD_PI));
      case Zoo::compound:
        return at(pair_of_boxes(world, bumpy ? Vec3(0.09, 0.15, 0.2) : Vec3(1, 0.2, 0.6), bumpy ? 0.12 : 1.0),
                  bumpy ? -0.15 : -0.2, askew);
      case Zoo::hull:
        return bumpy ? at(octahedron(0.25), -0.25, askew)
                     : at(frustum(Vec3(2.2, 0, 0.9), Vec3(2, 0, 0.6), 0.4), -0.2);
      case Zoo::gimpact:
        return bumpy ? gimpact(world, star(0.25, 0.3), 0, Vec3(0, -0.15, 0))
                     : gimpact(world, box_grid(4, 1, 2, Vec3(4, 0.4, 1.2)), 0, Vec3(0, -0.2, 0));
      case Zoo::convex_mesh:
        return bumpy ? convex_mesh(world, softpoint::sphere(0.2, 1), 0, Vec3(0, -0.2, 0))
                     : convex_mesh(world, box_grid(4, 1, 2, Vec3(4, 0.4, 1.2)), 0, Vec3(0, -0.2, 0));
      case Zoo::triangle_mesh:
      case Zoo::scaled_mesh:
      case Zoo::height_field:
      case Zoo::deformable:
        break;
    }
    return terrain(world, kind, look);
  }

  // Free, of `mass` (kg), standing on its flat side `rest_height(kind)` below `position`.
  ZooThing loose(TestWorld& world, Zoo kind, double mass, const Vec3& position,
                 const btQuaternion& turned = upright()) {
    const auto at = [&](btCollisionShape* shape) {
      return ZooThing{&world.add(shape, mass, position, turned), nullptr};
    };
    const double rest = rest_height(kind);
    switch (kind) {
      case Zoo::sphere:
        return at(new btSphereShape(btScalar(rest)));
      case Zoo::capsule:
        return at(new btCapsuleShapeZ(btScalar(rest), btScalar(0.12)));
      case Zoo::cylinder:
        return at(new btCylinderShape(to_bt(Vec3(0.09, rest, 0.09))));
      case Zoo::cone:
        return at(new btConeShape(btScalar(0.09), btScalar(2 * rest)));
      case Zoo::compound:
        return at(pair_of_boxes(world, Vec3(0.04, rest, 0.07), 0.08));
      case Zoo::hull:
        return at(frustum(Vec3(0.1, 0, 0.08), Vec3(0.06, 0, 0.05), 2 * rest));
      case Zoo::gimpact:
        return gimpact(world, star(0.11, 2 * rest), mass, position, turned);
      case Zoo::convex_mesh:
        return convex_mesh(world, standing(prism(6, 1, 1, 0.09, 2 * rest)), mass, position, turned);
      default:
        return at(new btBoxShape(to_bt(Vec3(0.08, rest, 0.06))));
    }
  }
  static double rest_height(Zoo kind) {
    return kind == Zoo::sphere || kind == Zoo::convex_mesh ? 0.09 : kind == Zoo::compound ? 0.05 : 0.07;
  }

 private:
  static btQuaternion upright() { return btQuaternion::getIdentity(); }

  static btCollisionShape* octahedron(double size) {
    auto* hull = new btConvexHullShape;
    for (const double side : {-size, size}) {
      hull->addPoint(to_bt(Vec3(side, 0, 0)));
      hull->addPoint(to_bt(Vec3(0, side, 0)));
      hull->addPoint(to_bt(Vec3(0, 0, 0.8 * side)));
    }
    return hull;
  }
  // Half extents of foot and top in x and z.
  static btCollisionShape* frustum(const Vec3& foot, const Vec3& top, double height) {
    auto* hull = new btConvexHullShape;
    for (const int i : {0, 1, 2, 3}) {
      const Vec3 side(i & 1 ? 1 : -1, 1, i & 2 ? 1 : -1);
      hull->addPoint(to_bt(foot.cwiseProduct(side) - Vec3(0, 0.5 * height, 0)));
      hull->addPoint(to_bt(top.cwiseProduct(side) + Vec3(0, 0.5 * height, 0)));
    }
    return hull;
  }
  static btCollisionShape* pair_of_boxes(TestWorld& world, const Vec3& half, double offset) {
    auto* compound = new btCompoundShape;
    btCollisionShape& box = world.keep(new btBoxShape(to_bt(half)));
    for (const double x : {-offset, offset}) {
      compound->addChildShape(btTransform(upright(), to_bt(Vec3(x, 0, 0))), &box);
    }
    return compound;
  }
  // The axis of a prism along y.
  static TriangleMesh standing(TriangleMesh mesh) {
    for (Vec3& p : mesh.vertices) p = Vec3(p.y(), p.z(), p.x());
    return mesh;
  }
  // A five-pointed star, upright: hollow between its points.
  static TriangleMesh star(double radius, double height) {
    TriangleMesh mesh = prism(10, 1, 1, radius, height);
    for (Vec3& p : mesh.vertices) {
      const double angle = std::atan2(p.y(), p.x());
      const bool inner = std::lround(angle / (std::numbers::pi / 5)) % 2 != 0;
      p = inner ? Vec3(0.5 * p.x(), 0.5 * p.y(), p.z()) : p;
    }
    return standing(mesh);
  }

  btTriangleMesh& keep(const TriangleSurface& surface, const Vec3& scale = Vec3::Ones()) {
    meshes_.push_back(std::make_unique<btTriangleMesh>());
    for (const auto& [a, b, c] : surface.triangles) {
      meshes_.back()->addTriangle(to_bt(a.cwiseQuotient(scale)), to_bt(b.cwiseQuotient(scale)),
                                  to_bt(c.cwiseQuotient(scale)));
    }
    return *meshes_.back();
  }
  const TriangleSurface& keep(TriangleSurface&& surface) {
    surfaces_.push_back(std::make_unique<TriangleSurface>(std::move(surface)));
    return *surfaces_.back();
  }
  ZooThing gimpact(TestWorld& world, const TriangleMesh& mesh, double mass, const Vec3& position,
                   const btQuaternion& turned = upright()) {
    const TriangleSurface& surface = keep(surface_of(mesh));
    auto* shape = new btGImpactMeshShape(&keep(surface));
    shape->updateBound();
    return {&world.add(shape, mass, position, turned), &surface};
  }
  ZooThing convex_mesh(TestWorld& world, const TriangleMesh& mesh, double mass, const Vec3& position,
                       const btQuaternion& turned = upright()) {
    const TriangleSurface& surface = keep(surface_of(mesh));
    return {&world.add(new btConvexTriangleMeshShape(&keep(surface)), mass, position, turned), &surface};
  }

  // 24 x 12 cells with the diagonals that Bullet's height field has.
  ZooThing terrain(TestWorld& world, Zoo kind, Ground look) {
    constexpr int kX = 24, kZ = 12;
    constexpr double kCell = 0.125;
    const auto height = [&](int i, int k) {
      const double x = kCell * (i - kX / 2), z = kCell * (k - kZ / 2);
      if (look == Ground::bumpy) {  // a spike beside the middle of rough ground
        return 0.05 * std::sin(5 * x + 0.3) * std::cos(4 * z) + (i == kX / 2 && k == kZ / 2 ? 0.08 : 0.0);
      }
      return look == Ground::rolling ? 0.02 * std::sin(3 * x) * std::cos(2 * z) : 0.0;
    };
    const auto point = [&](int i, int k) {
      return Vec3(kCell * (i - kX / 2), height(i, k), kCell * (k - kZ / 2));
    };
    TriangleSurface made;
    made.terrain = true;
    for (int k = 0; k < kZ; ++k) {
      for (int i = 0; i < kX; ++i) {
        made.triangles.push_back({point(i, k), point(i, k + 1), point(i + 1, k)});
        made.triangles.push_back({point(i + 1, k), point(i, k + 1), point(i + 1, k + 1)});
      }
    }
    const TriangleSurface& surface = keep(std::move(made));
    btCollisionShape* shape = nullptr;
    if (kind == Zoo::height_field) {
      for (int k = 0; k <= kZ; ++k) {
        for (int i = 0; i <= kX; ++i) heights_.push_back(btScalar(height(i, k)));
      }
      shape = new btHeightfieldTerrainShape(kX + 1, kZ + 1, heights_.data(), btScalar(-0.5), btScalar(0.5), 1,
                                            false);
      shape->setLocalScaling(btVector3(btScalar(kCell), 1, btScalar(kCell)));
    } else if (kind == Zoo::scaled_mesh) {
      const Vec3 scale(1.5, 0.8, 1.25);
      auto* plain = new btBvhTriangleMeshShape(&keep(surface, scale), true);
      world.keep(plain);
      shape = new btScaledBvhTriangleMeshShape(plain, to_bt(scale));
    } else {
      shape = new btBvhTriangleMeshShape(&keep(surface), true);
    }
    return {&world.add(shape, 0, Vec3::Zero()), &surface};
  }

  std::vector<std::unique_ptr<btTriangleMesh>> meshes_;
  std::vector<std::unique_ptr<TriangleSurface>> surfaces_;
  std::vector<btScalar> heights_;  // of one height field
};

}  // namespace softpoint

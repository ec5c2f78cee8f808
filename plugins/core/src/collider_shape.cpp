#include "collider_shape.h"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvexTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>

#include <algorithm>
#include <cstring>

#include "shape_features.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Everything a ColliderShape depends on, in nine numbers.
void fingerprint(const btCollisionShape& shape, double (&out)[9]) {
  std::fill(std::begin(out), std::end(out), 0.0);
  out[0] = shape.getShapeType();
  out[1] = shape.getMargin();
  if (shape.getShapeType() == STATIC_PLANE_PROXYTYPE) {
    const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
    const Vec3 n = from_bullet(plane.getPlaneNormal());
    std::copy(n.data(), n.data() + 3, out + 2);
    out[5] = plane.getPlaneConstant();
    return;
  }
  btVector3 low, high;
  shape.getAabb(btTransform::getIdentity(), low, high);
  const Vec3 a = from_bullet(low), b = from_bullet(high);
  std::copy(a.data(), a.data() + 3, out + 2);
  std::copy(b.data(), b.data() + 3, out + 5);
  if (shape.isPolyhedral() && shape.getShapeType() != CONVEX_TRIANGLEMESH_SHAPE_PROXYTYPE) {
    const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
    for (int i = 0; i < polyhedron.getNumVertices(); ++i) {
      btVector3 v;
      polyhedron.getVertex(i, v);
      out[8] += (i + 1) * from_bullet(v).dot(Vec3(1.0, 1.7, 2.3));
    }
  }
}

// Points of a polyhedral shape; empty where Bullet cannot tell them.
std::vector<Vec3> points_of(const btCollisionShape& shape) {
  std::vector<Vec3> points;
  if (shape.getShapeType() == CONVEX_TRIANGLEMESH_SHAPE_PROXYTYPE) {
    struct Collect final : btInternalTriangleIndexCallback {
      void internalProcessTriangleIndex(btVector3* triangle, int, int) override {
        for (int k = 0; k < 3; ++k) {
          points->push_back(from_bullet(triangle[k] * scaling));
        }
      }
      std::vector<Vec3>* points = nullptr;
      btVector3 scaling;
    } collect;
    const auto& mesh = static_cast<const btConvexTriangleMeshShape&>(shape);
    collect.points = &points;
    collect.scaling = mesh.getLocalScaling();
    const btVector3 all(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
    mesh.getMeshInterface()->InternalProcessAllTriangles(&collect, -all, all);
  } else if (shape.isPolyhedral()) {
    const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
    for (int i = 0; i < polyhedron.getNumVertices(); ++i) {
      btVector3 v;
      polyhedron.getVertex(i, v);
      points.push_back(from_bullet(v));
    }
  }
  return points;
}

void build_convex(ColliderShape& s, const btConvexShape& shape) {
  const std::vector<Vec3> points = points_of(shape);
  if (points.size() == 3) {  // a lone triangle has two sides and no inside
    ShapeFacet facet{points[0], points[1], points[2],
                     (points[1] - points[0]).cross(points[2] - points[0]).normalized()};
    facet.offset = facet.normal.dot(facet.a);
    s.facets.push_back(facet);
    s.kind = ColliderShape::Kind::mesh;
  } else if (!points.empty()) {
    add_hull_facets(s, points);
    s.kind = ColliderShape::Kind::polyhedron;
  }
  if (s.facets.empty()) {
    s.kind = ColliderShape::Kind::round;
    s.convex = &shape;
  } else {
    FeatureWorkspace work;
    add_facet_features(s, work);
  }
}

ColliderShape build(const btCollisionShape& shape) {
  ColliderShape s;
  btVector3 low, high;
  shape.getAabb(btTransform::getIdentity(), low, high);
  s.bounds_min = from_bullet(low);
  s.bounds_max = from_bullet(high);
  s.thinnest = (s.bounds_max - s.bounds_min).minCoeff();
  switch (shape.getShapeType()) {
    case STATIC_PLANE_PROXYTYPE: {
      const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
      s.kind = ColliderShape::Kind::plane;
      s.plane_normal = from_bullet(plane.getPlaneNormal()).normalized();
      s.plane_offset = plane.getPlaneConstant();
      s.thinnest = std::numeric_limits<double>::infinity();
      break;
    }
    case SPHERE_SHAPE_PROXYTYPE:
      s.kind = ColliderShape::Kind::sphere;
      s.radius = static_cast<const btSphereShape&>(shape).getRadius();
      break;
    case BOX_SHAPE_PROXYTYPE:
      s.kind = ColliderShape::Kind::box;
      s.half = from_bullet(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin());
      add_box_features(s);
      break;
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      s.kind = ColliderShape::Kind::capsule;
      s.axis = capsule.getUpAxis();
      s.radius = capsule.getRadius();
      s.half[s.axis] = capsule.getHalfHeight();
      break;
    }
    case CYLINDER_SHAPE_PROXYTYPE: {
      const auto& cylinder = static_cast<const btCylinderShape&>(shape);
      s.kind = ColliderShape::Kind::cylinder;
      s.axis = cylinder.getUpAxis();
      s.radius = cylinder.getRadius();
      s.half[s.axis] = from_bullet(cylinder.getHalfExtentsWithMargin())[s.axis];
      add_cylinder_features(s);
      break;
    }
    case CONE_SHAPE_PROXYTYPE: {
      const auto& cone = static_cast<const btConeShape&>(shape);
      s.kind = ColliderShape::Kind::cone;
      s.axis = cone.getConeUpIndex();
      s.radius = cone.getRadius();
      s.half[s.axis] = 0.5 * double(cone.getHeight());
      add_cone_features(s);
      break;
    }
    default:
      if (shape.isConvex()) {
        build_convex(s, static_cast<const btConvexShape&>(shape));
      }
      break;
  }
  return s;
}

}  // namespace

bool is_mesh(const btCollisionShape& shape) {
  return shape.isConcave() && shape.getShapeType() != STATIC_PLANE_PROXYTYPE &&
         shape.getShapeType() != EMPTY_SHAPE_PROXYTYPE && shape.getShapeType() != SDF_SHAPE_PROXYTYPE;
}

void ColliderShapes::begin_substep() {
  constexpr long long kMemory = 1024;  // substeps
  if (++substep_ % kMemory == 0) {
    std::erase_if(entries_, [&](const auto& item) { return substep_ - item.second.last_used > kMemory; });
  }
}

const ColliderShape& ColliderShapes::get(const btCollisionShape& shape) {
  double now[9];
  fingerprint(shape, now);
  Entry& entry = entries_[&shape];
  entry.last_used = substep_;
  if (std::memcmp(entry.fingerprint, now, sizeof now) != 0) {
    entry.shape = build(shape);
    std::copy(std::begin(now), std::end(now), entry.fingerprint);
  }
  return entry.shape;
}

}  // namespace softpoint::inline SOFTPOINT_ABI

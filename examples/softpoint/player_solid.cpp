#include "player_solid.h"

#include <Eigen/Geometry>

#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

ConvexSolid::ConvexSolid(const ShapeSpec& shape) : shape_(shape) {
  const double r = shape.radius, l = shape.length;
  switch (shape.kind) {
    case ShapeKind::kBox:
      for (int k = 0; k < 8; ++k) {
        corners_.push_back(0.5 *
                           shape.size.cwiseProduct(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)));
      }
      volume_ = shape.size.prod();
      reach_ = 0.5 * shape.size.norm();
      break;
    case ShapeKind::kSphere:
      volume_ = 4.0 / 3.0 * pi * r * r * r;
      reach_ = r;
      break;
    case ShapeKind::kCapsule:
      volume_ = pi * r * r * (l + 4.0 / 3.0 * r);
      reach_ = 0.5 * l + r;
      break;
    case ShapeKind::kCylinder:
      volume_ = pi * r * r * l;
      reach_ = std::hypot(r, 0.5 * l);
      break;
    case ShapeKind::kCone:
      volume_ = pi * r * r * l / 3.0;
      center_[shape.axis] = -0.25 * l;
      reach_ = std::hypot(r, 0.5 * l);
      break;
    case ShapeKind::kPlane:
      volume_ = reach_ = kInfinity;
      break;
    case ShapeKind::kHull:
      build_hull();
      break;
    case ShapeKind::kMesh:
    case ShapeKind::kCompound:
      throw Error("ConvexSolid: a mesh or compound is not convex");
  }
}

void ConvexSolid::build_hull() {
  btConvexHullComputer hull;
  hull.compute(shape_.points.front().data(), sizeof(Vec3), static_cast<int>(shape_.points.size()), 0, 0);
  Vec3 middle = Vec3::Zero();
  for (int k = 0; k < hull.vertices.size(); ++k) {
    // The given points: Bullet rounds its own to a grid.
    corners_.push_back(shape_.points[static_cast<std::size_t>(hull.original_vertex_index[k])]);
    middle += corners_.back() / hull.vertices.size();
    reach_ = std::max(reach_, corners_.back().norm());
  }
  Vec3 moment = Vec3::Zero();
  for (int f = 0; f < hull.faces.size(); ++f) {
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[f]];
    const auto corner = [&](const btConvexHullComputer::Edge* edge) {
      return corners_[static_cast<std::size_t>(edge->getSourceVertex())];
    };
    const Vec3 a = corner(first);
    Vec3 area = Vec3::Zero();
    for (auto* edge = first->getNextEdgeOfFace(); edge->getNextEdgeOfFace() != first;
         edge = edge->getNextEdgeOfFace()) {
      const Vec3 b = corner(edge), c = corner(edge->getNextEdgeOfFace());
      area += (b - a).cross(c - a);
      // A tetrahedron from the middle to each triangle, whichever way Bullet's faces run.
      const double volume = std::abs((a - middle).dot((b - middle).cross(c - middle))) / 6.0;
      volume_ += volume;
      moment += volume * (a + b + c + middle) / 4.0;
    }
    if (area.norm() > 0.0) {
      const Vec3 normal = area.normalized() * (area.dot(a - middle) < 0.0 ? -1.0 : 1.0);
      planes_.push_back({normal, normal.dot(a)});
    }
  }
  if (!(volume_ > 1e-15)) {
    throw Error(
        "the convex hull of these vertices has no volume; permitted are vertices that do not lie in a plane");
  }
  center_ = moment / volume_;
}

double ConvexSolid::depth(const Vec3& p) const {
  const auto axis = static_cast<Eigen::Index>(shape_.axis);
  const double along = p[axis];
  const double across = (p - along * Vec3::Unit(axis)).norm();
  const double half = 0.5 * shape_.length;
  switch (shape_.kind) {
    case ShapeKind::kBox:
      return (0.5 * shape_.size - p.cwiseAbs()).minCoeff();
    case ShapeKind::kSphere:
      return shape_.radius - p.norm();
    case ShapeKind::kCapsule:
      return shape_.radius - std::hypot(across, along - std::clamp(along, -half, half));
    case ShapeKind::kCylinder:
      return std::min(shape_.radius - across, half - std::abs(along));
    case ShapeKind::kCone: {
      const double slant = std::hypot(shape_.radius, shape_.length);
      return std::min(half + along, (shape_.radius * (half - along) - shape_.length * across) / slant);
    }
    case ShapeKind::kPlane:
      return shape_.offset - shape_.normal.dot(p);
    default: {
      double depth = kInfinity;
      for (const Plane& plane : planes_) {
        depth = std::min(depth, plane.offset - plane.normal.dot(p));
      }
      return depth;
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

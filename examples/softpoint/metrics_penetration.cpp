#include "metrics_penetration.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

// Signed solid angle of a triangle seen from the origin (van Oosterom and Strackee 1983, equation 8).
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

double distance_to_segment(const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double s = std::clamp(-a.dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (a + s * along).norm();
}

// Distance of the origin from a triangle.
double distance_to_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 area = (b - a).cross(c - a);
  const double area2 = area.squaredNorm();
  const bool over = a.cross(b).dot(area) >= 0.0 && b.cross(c).dot(area) >= 0.0 && c.cross(a).dot(area) >= 0.0;
  if (over && area2 > 0.0) {
    return std::abs(a.dot(area)) / std::sqrt(area2);
  }
  return std::min({distance_to_segment(a, b), distance_to_segment(b, c), distance_to_segment(c, a)});
}

struct Bounds {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
};

Bounds bounds(const Surface& surface) {
  Bounds result;
  for (const Vec3& point : surface.points()) {
    result.low = result.low.cwiseMin(point);
    result.high = result.high.cwiseMax(point);
  }
  return result;
}

void measure_pair(const Deformable& soft, const ConvexSolid& solid, const Placement& at, Depth& vertex,
                  Depth& corner) {
  const auto points = soft.points();
  for (std::size_t v = 0; v < points.size(); ++v) {
    const double depth = solid.depth(at.to_local(points[v]));
    if (depth > vertex.depth) {
      vertex.depth = depth;
      vertex.point = static_cast<int>(v);
    }
  }
  for (std::size_t c = 0; c < solid.corners().size(); ++c) {
    const double depth = depth_below_skin(soft, at.to_world(solid.corners()[c]));
    if (depth > corner.depth) {
      corner.depth = depth;
      corner.point = static_cast<int>(c);
    }
  }
}

}  // namespace

double depth_below_skin(const Surface& surface, const Vec3& point) {
  const auto points = surface.points();
  double angle = 0, distance = std::numeric_limits<double>::infinity();
  for (const Triangle& face : surface.faces()) {
    const Vec3 a = points[static_cast<std::size_t>(face[0])] - point;
    const Vec3 b = points[static_cast<std::size_t>(face[1])] - point;
    const Vec3 c = points[static_cast<std::size_t>(face[2])] - point;
    angle += solid_angle(a, b, c);
    distance = std::min(distance, distance_to_triangle(a, b, c));
  }
  // 4 pi inside a closed surface, 0 outside.
  return angle > 2.0 * std::numbers::pi ? distance : 0.0;
}

Penetration measure_penetration(const Player& player) {
  Penetration worst;
  for (std::size_t d = 0; d < player.deformable_count(); ++d) {
    if (!player.present({true, static_cast<int>(d)})) {
      continue;
    }
    const Deformable& soft = player.deformable(d);
    const Bounds box = bounds(soft);
    const Vec3 middle = 0.5 * (box.low + box.high);
    const double reach = 0.5 * (box.high - box.low).norm();
    for (std::size_t r = 0; r < player.rigid_count(); ++r) {
      if (!player.present({false, static_cast<int>(r)})) {
        continue;
      }
      Depth vertex, corner;
      const RigidActor& actor = player.rigid(r);
      for (std::size_t k = 0; k < actor.solid_count(); ++k) {
        const Placement at = actor.solid_placement(k);
        if ((at.position - middle).norm() <= reach + actor.solid(k).reach()) {
          measure_pair(soft, actor.solid(k), at, vertex, corner);
        }
      }
      for (std::size_t c = 0; c < actor.mesh_corners().size(); ++c) {
        const Vec3 at = actor.placement().to_world(actor.mesh_corners()[c]);
        if ((at - middle).norm() > reach) {
          continue;
        }
        if (const double depth = depth_below_skin(soft, at); depth > corner.depth) {
          corner.depth = depth;
          corner.point = static_cast<int>(c);
        }
      }
      for (Depth* depth : {&vertex, &corner}) {
        depth->frame = player.frame();
        depth->deformable = player.scene().deformables[d].name;
        depth->rigid = player.scene().rigid_bodies[r].name;
      }
      worst.vertex.take(vertex);
      worst.corner.take(corner);
    }
  }
  return worst;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#include "panels.h"

#include <Eigen/Geometry>

#include <algorithm>

#include "kernels.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

constexpr int kMostLanes = 8;

}  // namespace

Panels::Panels(const TriangleMesh& mesh, const Vec3& origin) : triangles_(mesh.triangles) {
  const int count = mesh.triangle_count();
  stride_ = count + kMostLanes;
  fields_.assign(kPanelFields * stride_, 0.0);
  const auto set = [this](int field, int f, const Vec3& v) {
    for (int i = 0; i < 3; ++i) fields_[(field + i) * stride_ + f] = v[i];
  };
  for (int f = 0; f < count; ++f) {
    Vec3 v[3], edge[3];
    for (int k = 0; k < 3; ++k) v[k] = mesh.vertices[triangles_[f][k]] - origin;
    for (int k = 0; k < 3; ++k) edge[k] = v[(k + 1) % 3] - v[k];
    const Vec3 twice = edge[0].cross(edge[1]);
    const double twice_area = twice.norm();
    const Vec3 n = twice / twice_area;
    double longest = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double length = edge[k].norm();
      const Vec3 tangent = edge[k] / length;
      set(kFieldVertex + 3 * k, f, v[k]);
      set(kFieldTangent + 3 * k, f, tangent);
      set(kFieldConormal + 3 * k, f, tangent.cross(n));
      fields_[(kFieldLength + k) * stride_ + f] = length;
      longest = std::max(longest, length);
      curl_.push_back(-edge[(k + 1) % 3] / twice_area);
      corner_.push_back(v[k]);
    }
    for (int a = 0; a < 2; ++a) set(kFieldGradient + 3 * a, f, n.cross(edge[(a + 1) % 3]) / twice_area);
    set(kFieldNormal, f, n);
    fields_[kFieldTwiceArea * stride_ + f] = twice_area;
    normal_.push_back(n);
    centroid_.push_back((v[0] + v[1] + v[2]) / 3.0);
    area_.push_back(0.5 * twice_area);
    longest_.push_back(longest);
  }
  // So that a kernel may take whole packs up to the end.
  for (int k = 0; k < kPanelFields; ++k) {
    std::fill_n(fields_.begin() + k * stride_ + count, kMostLanes, fields_[k * stride_ + count - 1]);
  }
}

bool Panels::near(int f, int g, double distance) const {
  const double reach = distance * std::max(longest_[f], longest_[g]);
  if ((centroid_[f] - centroid_[g]).squaredNorm() < reach * reach) return true;
  for (int a : triangles_[f]) {
    if (std::find(triangles_[g].begin(), triangles_[g].end(), a) != triangles_[g].end()) return true;
  }
  return false;
}

void Panels::place(const Rule& rule, int f, std::vector<double>& points) const {
  points.clear();
  const Vec3* v = &corner_[3 * f];
  for (const RulePoint& p : rule) {
    const Vec3 x = p.a * v[0] + p.b * v[1] + (1.0 - p.a - p.b) * v[2];
    points.insert(points.end(), {x.x(), x.y(), x.z(), p.weight * area_[f]});
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#pragma once

#include <cstddef>
#include <vector>

#include "quadrature.h"
#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// The triangles of a mesh ("panels") with what the boundary integrals need of them.
class Panels {
 public:
  // Coordinates are taken relative to `origin`, which should be near the mesh: rounding grows with distance.
  Panels(const TriangleMesh& mesh, const Vec3& origin);

  int count() const { return static_cast<int>(area_.size()); }
  const Triangle& vertices(int f) const { return triangles_[f]; }
  double area(int f) const { return area_[f]; }
  const Vec3& normal(int f) const { return normal_[f]; }
  // c_a = n x grad phi_a, equation (4).
  const Vec3& curl(int f, int a) const { return curl_[3 * f + a]; }

  // PanelField k of panel f is fields()[k * stride() + f]; room for `lanes` more at the end repeats the last.
  const double* fields() const { return fields_.data(); }
  std::ptrdiff_t stride() const { return stride_; }

  // Share a vertex, or centroids closer than `distance` times the longest edge of both.
  bool near(int f, int g, double distance) const;

  // x, y, z and weight (summing up to the area) of a rule's points on panel f.
  void place(const Rule& rule, int f, std::vector<double>& points) const;

 private:
  std::vector<Triangle> triangles_;
  std::vector<Vec3> corner_;  // 3F
  std::vector<Vec3> normal_, centroid_, curl_;
  std::vector<double> area_, longest_;
  std::vector<double> fields_;
  std::ptrdiff_t stride_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#include "shape_features.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

constexpr double kSagitta = 5e-4;  // m, between a rim and the polygon that stands for it

int rim_corners(double radius) {
  const double c = 1.0 - std::min(kSagitta / radius, 1.0);
  return std::clamp(static_cast<int>(std::ceil(std::numbers::pi / std::acos(c))), 12, 64);
}

// Unit direction `i` of `count` round `axis`.
Vec3 around(int axis, int i, int count) {
  const double angle = 2.0 * std::numbers::pi * i / count;
  Vec3 result = Vec3::Zero();
  result[(axis + 1) % 3] = std::cos(angle);
  result[(axis + 2) % 3] = std::sin(angle);
  return result;
}

void add_edge(ColliderShape& s, const Vec3& a, const Vec3& b, const Vec3& toward_first,
              const Vec3& toward_second) {
  // Directions into the faces, square to the edge.
  const Vec3 along = (b - a).normalized();
  const auto square = [&](const Vec3& d) { return Vec3((d - d.dot(along) * along).normalized()); };
  s.edges.push_back({a, b, square(toward_first), square(toward_second)});
}

void index_features(ColliderShape& s, FeatureWorkspace& work) {
  std::vector<Bounds>& boxes = work.boxes;
  boxes.clear();
  for (const Vec3& corner : s.corners) {
    boxes.push_back(Bounds::of(corner));
  }
  s.corner_tree.build(boxes);
  boxes.clear();
  for (const ShapeEdge& edge : s.edges) {
    boxes.push_back(Bounds::of(edge.a));
    boxes.back().include(edge.b);
  }
  s.edge_tree.build(boxes);
}

// Directions of a corner's edges, where every edge ends in two of the corners.
void connect_corners(ColliderShape& s) {
  for (const Vec3& corner : s.corners) {
    s.corner_edges_from.push_back(static_cast<int>(s.corner_edges.size()));
    for (const ShapeEdge& edge : s.edges) {
      if (corner == edge.a) s.corner_edges.push_back((edge.b - edge.a).normalized());
      if (corner == edge.b) s.corner_edges.push_back((edge.a - edge.b).normalized());
    }
  }
  s.corner_edges_from.push_back(static_cast<int>(s.corner_edges.size()));
  FeatureWorkspace work;
  index_features(s, work);
}

}  // namespace

void add_box_features(ColliderShape& s) {
  for (int i = 0; i < 8; ++i) {
    s.corners.push_back(s.half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int k = 0; k < 4; ++k) {
      const double su = k & 1 ? 1 : -1, sv = k & 2 ? 1 : -1;
      ShapeEdge edge;
      edge.a[axis] = -s.half[axis];
      edge.b[axis] = s.half[axis];
      edge.a[u] = edge.b[u] = su * s.half[u];
      edge.a[v] = edge.b[v] = sv * s.half[v];
      edge.into_first[u] = -su;
      edge.into_second[v] = -sv;
      s.edges.push_back(edge);
    }
  }
  connect_corners(s);
}

void add_cylinder_features(ColliderShape& s) {
  const int count = rim_corners(s.radius);
  for (const int side : {-1, 1}) {
    for (int i = 0; i < count; ++i) {
      s.corners.push_back(s.radius * around(s.axis, i, count) + side * s.half);
    }
  }
  const auto corner = [&](int side, int i) -> const Vec3& {
    return s.corners[static_cast<std::size_t>((side > 0 ? count : 0) + i % count)];
  };
  for (int i = 0; i < count; ++i) {
    for (const int side : {-1, 1}) {
      add_edge(s, corner(side, i), corner(side, i + 1), side * s.half - corner(side, i),
               corner(-side, i) - corner(side, i));
    }
    add_edge(s, corner(-1, i), corner(1, i), corner(1, i + count - 1) - corner(1, i),
             corner(1, i + 1) - corner(1, i));
  }
  connect_corners(s);
}

void add_cone_features(ColliderShape& s) {
  const int count = rim_corners(s.radius);
  for (int i = 0; i < count; ++i) {
    s.corners.push_back(s.radius * around(s.axis, i, count) - s.half);
  }
  const Vec3 tip = s.half;
  for (int i = 0; i < count; ++i) {
    const Vec3& a = s.corners[static_cast<std::size_t>(i)];
    const Vec3& b = s.corners[static_cast<std::size_t>((i + 1) % count)];
    const Vec3& before = s.corners[static_cast<std::size_t>((i + count - 1) % count)];
    add_edge(s, a, b, -s.half - a, tip - a);
    add_edge(s, a, tip, before - a, b - a);
  }
  s.corners.push_back(tip);
  connect_corners(s);
}

void add_facet_features(ColliderShape& s, FeatureWorkspace& work) {
  constexpr double kFlat = 0.99985;  // cosine of one degree
  // Vertices are one where they are the same point.
  std::vector<Vec3>& points = work.points;
  points.clear();
  for (const ShapeFacet& f : s.facets) {
    points.insert(points.end(), {f.a, f.b, f.c});
  }
  const auto less = [](const Vec3& p, const Vec3& q) {
    return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  };
  std::sort(points.begin(), points.end(), less);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  const auto index = [&](const Vec3& p) {
    return static_cast<int>(std::lower_bound(points.begin(), points.end(), p, less) - points.begin());
  };
  auto& sides = work.sides;
  sides.clear();
  for (const ShapeFacet& facet : s.facets) {
    const Vec3* corner[3] = {&facet.a, &facet.b, &facet.c};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = *corner[k];
      const Vec3& q = *corner[(k + 1) % 3];
      const Vec3 along = (q - p).normalized();
      const Vec3 inward = *corner[(k + 2) % 3] - p;
      const int i = index(p), j = index(q);
      sides.push_back({std::min(i, j), std::max(i, j), static_cast<int>(sides.size()),
                       (inward - inward.dot(along) * along).normalized()});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const auto& x, const auto& y) {
    return x.a != y.a ? x.a < y.a : x.b != y.b ? x.b < y.b : x.number < y.number;
  });
  work.sharp.assign(points.size(), 0);
  auto& ends = work.ends;
  ends.clear();
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].a == sides[i].a && sides[end].b == sides[i].b) {
      ++end;
    }
    const auto a = static_cast<std::size_t>(sides[i].a), b = static_cast<std::size_t>(sides[i].b);
    ends.push_back({sides[i].a, sides[i].b});
    ends.push_back({sides[i].b, sides[i].a});
    // Facets may overlap (fans over one face): the second side is the one that leads away from the first
    // most.
    const bool rim = end == i + 1;
    Vec3 second = sides[i].into;
    for (std::size_t k = i + 1; k < end; ++k) {
      if (sides[k].into.dot(sides[i].into) < second.dot(sides[i].into)) {
        second = sides[k].into;
      }
    }
    const double cosine = second.dot(sides[i].into);
    if (rim || (cosine > -kFlat && cosine < kFlat)) {
      s.edges.push_back({points[a], points[b], sides[i].into, rim ? Vec3(Vec3::Zero()) : second});
      work.sharp[a] = work.sharp[b] = 1;
    }
    i = end;
  }
  std::sort(ends.begin(), ends.end());
  auto end = ends.begin();
  for (std::size_t v = 0; v < points.size(); ++v) {
    const auto first = end;
    while (end != ends.end() && (*end)[0] == static_cast<int>(v)) {
      ++end;
    }
    if (work.sharp[v] == 0) {
      continue;
    }
    s.corners.push_back(points[v]);
    s.corner_edges_from.push_back(static_cast<int>(s.corner_edges.size()));
    for (auto e = first; e != end; ++e) {
      s.corner_edges.push_back((points[static_cast<std::size_t>((*e)[1])] - points[v]).normalized());
    }
  }
  s.corner_edges_from.push_back(static_cast<int>(s.corner_edges.size()));
  index_features(s, work);
  std::vector<Bounds>& boxes = work.boxes;
  boxes.clear();
  for (const ShapeFacet& f : s.facets) {
    boxes.push_back(Bounds::of(f.a));
    boxes.back().include(f.b);
    boxes.back().include(f.c);
  }
  s.facet_tree.build(boxes);
}

}  // namespace softpoint::inline SOFTPOINT_ABI

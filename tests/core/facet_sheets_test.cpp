#include "facet_sheets.h"

#include <gtest/gtest.h>

#include "softpoint/core/shapes.h"

namespace softpoint {
namespace {

std::vector<ShapeFacet> facets_of(const TriangleMesh& mesh) {
  std::vector<ShapeFacet> facets;
  for (const Triangle& t : mesh.triangles) {
    const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    ShapeFacet facet{at(0), at(1), at(2), (at(1) - at(0)).cross(at(2) - at(0)).normalized()};
    facet.offset = facet.normal.dot(facet.a);
    facets.push_back(facet);
  }
  return facets;
}

TEST(FacetSheets, TurnsTheFewerOnesOfEverySheet) {
  const std::vector<ShapeFacet> outward = facets_of(sphere(0.5, 2));
  std::vector<ShapeFacet> inward = facets_of(sphere(0.3, 1));  // another sheet, and all of it runs inward
  std::vector<ShapeFacet> mixed = outward;
  for (ShapeFacet& f : inward) {
    std::swap(f.b, f.c);
    f.normal = -f.normal;
    f.offset = -f.offset;
  }
  for (std::size_t f = 0; f < mixed.size(); f += 3) {
    std::swap(mixed[f].b, mixed[f].c);
    mixed[f].normal = -mixed[f].normal;
    mixed[f].offset = -mixed[f].offset;
  }
  mixed.insert(mixed.end(), inward.begin(), inward.end());
  FacetSheets sheets;
  sheets.align(mixed);
  for (std::size_t f = 0; f < mixed.size(); ++f) {
    const ShapeFacet& facet = mixed[f];
    const double outside = f < outward.size() ? 1.0 : -1.0;
    EXPECT_GT(outside * facet.normal.dot(facet.a), 0.0) << f;
    EXPECT_GT((facet.b - facet.a).cross(facet.c - facet.a).dot(facet.normal), 0.0) << f;
    EXPECT_NEAR(facet.offset, facet.normal.dot(facet.a), 1e-15) << f;
  }
}

}  // namespace
}  // namespace softpoint

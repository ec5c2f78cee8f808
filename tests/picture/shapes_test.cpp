#include "shapes.h"

#include <Eigen/Geometry>

#include <map>
#include <numbers>

#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

using std::numbers::pi;

// Divergence theorem: a sixth of the sum of the triangles' triple products.
double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](int i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
    sum += at(a).dot(at(b).cross(at(c))) / 6;
  }
  return sum;
}

bool closed_and_oriented(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> sides;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  }
  return std::all_of(sides.begin(), sides.end(), [&](const auto& side) {
    const auto back = sides.find({side.first.second, side.first.first});
    return side.second == 1 && back != sides.end() && back->second == 1;
  });
}

TEST(Shapes, AreClosedAndHaveTheirVolume) {
  const struct {
    const char* name;
    TriangleMesh mesh;
    double volume;
  } cases[] = {{"box", unit_box(), 8},
               {"sphere", unit_sphere(80, 40), 4 * pi / 3},
               {"cylinder", unit_cylinder(80), 2 * pi},
               {"cone", unit_cone(80), 2 * pi / 3},
               {"capsule", capsule(0.5, 0.75, 80, 40), pi * 0.25 * 1.5 + 4 * pi / 3 * 0.125}};
  for (const auto& c : cases) {
    EXPECT_TRUE(closed_and_oriented(c.mesh)) << c.name;
    EXPECT_NEAR(volume(c.mesh), c.volume, 0.005 * c.volume) << c.name;
    EXPECT_LE(volume(c.mesh), c.volume + 1e-12) << c.name << ": corners lie on the true surface";
  }
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture

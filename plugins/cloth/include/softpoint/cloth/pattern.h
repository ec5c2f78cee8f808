#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "softpoint/cloth/fabric.h"
#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// What a spring stands for.
enum class SpringKind : std::int8_t { kWarp, kWeft, kShear, kBend };

// Pulls two points to a distance.
struct Spring {
  int a = 0;             // points; a < b
  int b = 0;             //
  double rest = 0;       // length without force, m
  double stiffness = 0;  // in tension, N/m; times the fabric's compression ratio when shortened
  SpringKind kind = SpringKind::kWarp;
};

// Resists folding: energy 1/2 stiffness |sum_k weight[k] x(point[k])|^2 with weights that sum to zero, so
// that it is zero for a flat rest shape and does not change under a turn or a shift.
struct BendElement {
  int point[4] = {0, 0, 0, 0};
  double weight[4] = {0, 0, 0, 0};
  double stiffness = 0;  // N/m
};

// A cloth before it is put anywhere: points in the rest shape, faces counter-clockwise seen from the front,
// springs and masses. What holds it together is the springs; the faces carry air, contact and pictures.
struct ClothPattern {
  std::vector<Vec3> points;        // m
  std::vector<Triangle> faces;     //
  std::vector<Spring> springs;     //
  std::vector<BendElement> bends;  // none when the fabric's bending stiffness is 0
  std::vector<double> masses;      // dry, kg, one per point
  int columns = 0;                 // of a grid: point (i, j) has index j * columns + i; 0 when it is no grid
  int rows = 0;                    //
  double spacing = 0;              // shortest rest length of a structural spring, m

  // Number of points.
  int point_count() const { return static_cast<int>(points.size()); }
};

// How the mass of a sheet is given to its points.
enum class Lumping {
  kArea,   // a third of each face to its corners: right for borders too
  kEqual,  // the same to all points, as in the thesis
};

// Most points of a pattern.
inline constexpr int kMaxClothPoints = 1'000'000;

// A flat sheet in z = 0, facing +z, centred at the origin: `columns` x `rows` points (2 or more each) over
// `width` (x, along the warp) by `depth` (y, m). Springs to the eight neighbours; the diagonals of the faces
// alternate like a chessboard. Throws Error for a value out of range.
SOFTPOINT_API ClothPattern square_pattern(int columns, int rows, double width, double depth,
                                          const Fabric& fabric, Lumping lumping = Lumping::kArea);

// Any triangle surface, open or closed: a spring along each edge with the stiffness that makes a mesh of near
// equilateral or right triangles stretch like a membrane of E h = 4/3 warp_stiffness and Poisson's ratio 1/3
// (doc/solver.md, equation (18)), and bending elements across the edges. Warp and weft stiffness must agree
// there. Throws Error for what check_surface refuses and for values out of range.
SOFTPOINT_API ClothPattern mesh_pattern(const TriangleMesh& mesh, const Fabric& fabric);

// Throws Error unless every index, number and face of a pattern made by hand is sound.
SOFTPOINT_API void check(const ClothPattern& pattern, const std::string& name = "pattern");

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

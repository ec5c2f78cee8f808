#pragma once

#include <array>
#include <memory>
#include <vector>

#include "softpoint/core/triangle_mesh.h"
#include "softpoint/elastic/assembly_design.h"
#include "softpoint/elastic/segment_model.h"

// Ready-made segments and characters, put together as the figures of the first paper show them.
namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Sides of a box along whose z axis a bone runs.
enum class BoxSide { kLowX, kHighX, kLowY, kHighY };

// A disc in the side of a box, its joining surface for the end of a limb: a centre and 4 `cells` vertices on
// a circle, which the end of a prism of 4 `cells` sides meets one to one when it stands on it, turned about
// its own axis by a multiple of a right angle.
struct BoxPatch {
  BoxSide side = BoxSide::kHighX;
  int cells = 2;      // of the grid, across the disc; 2, 4, ...
  double radius = 0;  // m; half of `cells` cells is the natural size, at most half a cell more
  int along = 0;      // cells from the middle of the side along z
  int across = 0;     // cells from the middle of the side, along x or y
};

// A closed surface with joining surfaces, each beginning with its vertex on the bone.
struct SegmentShape {
  TriangleMesh mesh;
  std::vector<std::vector<int>> interfaces;  // root, tip, patches
};

// A prism with one cap ring: lower cap, upper cap.
SOFTPOINT_API SegmentShape prism_shape(int sides, int stacks, double radius, double length);
// A box_grid with its low and high z sides as joining surfaces, then the patches. Throws Error naming the
// field for counts of x or y cells that are odd (the bone runs through a vertex), and for patches that do
// not lie within their side, a cell from its edges, or share a vertex with another one.
SOFTPOINT_API SegmentShape box_shape(const std::array<int, 3>& cells, const Vec3& size,
                                     const std::vector<BoxPatch>& patches = {});
// What make_segment_model makes of a shape.
SOFTPOINT_API std::shared_ptr<const SegmentModel> make_segment(const SegmentShape& shape,
                                                               const Material& material,
                                                               const SegmentSettings& settings = {});

// The least turn that takes z to `axis` (any length but 0), after a turn by `roll` (rad) about z.
SOFTPOINT_API Mat3 turn_to_axis(const Vec3& axis, double roll = 0);

// A whole character: its parts, an exoskeleton round them, and what hangs on which of its vertices.
struct CharacterShape {
  struct Hanging {
    PartEnd end;
    int vertex = 0;
  };
  AssemblyDesign design;
  TriangleMesh exoskeleton;
  std::vector<Hanging> hangings;
};

// Figure 10: a body of three cylinders from the middle of the top of a cube to the middle of its bottom, and
// eight legs of four cylinders from there to the bottom's other vertices. y is up, the cube's middle at the
// origin; 2402 vertices are seen. `edge` (m) is the cube's, `radius` (m) that of the cylinders.
SOFTPOINT_API CharacterShape nine_part_character(double edge, double radius, const Material& material,
                                                 const SegmentSettings& settings = {});

// Figure 12: belly, chest and head in one part; two legs, two arms, two ears and a tail joined to its sides;
// an exoskeleton of 26 vertices round it all. y is up, the face looks along z, the torso's middle is the
// origin; 1466 vertices are seen. `size` (m) is the torso's height with the head.
SOFTPOINT_API CharacterShape eight_part_character(double size, const Material& material,
                                                  const SegmentSettings& settings = {});

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

// The characters of figures 10 and 12.
#include "softpoint/elastic/character_shapes.h"

#include <algorithm>

#include "softpoint/core/error.h"
#include "softpoint/core/shapes.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

int nearest_vertex(const TriangleMesh& mesh, const Vec3& position) {
  const auto nearest =
      std::min_element(mesh.vertices.begin(), mesh.vertices.end(), [&](const Vec3& a, const Vec3& b) {
        return (a - position).squaredNorm() < (b - position).squaredNorm();
      });
  return static_cast<int>(nearest - mesh.vertices.begin());
}

// A row of `count` cylinders from one place to another.
int add_row_between(AssemblyDesign& design, const std::string& name, int count, const Vec3& from,
                    const Vec3& to, double radius, const Material& material,
                    const SegmentSettings& settings) {
  const SegmentShape shape = prism_shape(16, 4, radius, (to - from).norm() / count);
  return design.add_row(name, make_segment(shape, material, settings), count, from, turn_to_axis(to - from));
}

}  // namespace

CharacterShape nine_part_character(double edge, double radius, const Material& material,
                                   const SegmentSettings& settings) {
  check_positive("nine_part_character: edge", edge);
  CharacterShape shape;
  shape.exoskeleton = box_grid(2, 2, 2, Vec3::Constant(edge));
  const auto hang = [&](int part, const Vec3& root, const Vec3& tip) {
    shape.hangings.push_back({{part, false}, nearest_vertex(shape.exoskeleton, root)});
    shape.hangings.push_back({{part, true}, nearest_vertex(shape.exoskeleton, tip)});
  };
  const double h = 0.5 * edge;
  const Vec3 top(0, h, 0), bottom(0, -h, 0);
  hang(add_row_between(shape.design, "body", 3, top, bottom, radius, material, settings), top, bottom);
  // Equal legs share their cylinders: the models are made for the first of each length.
  std::shared_ptr<const SegmentModel> straight, diagonal;
  for (int k = 0; k < 8; ++k) {
    static constexpr std::array<std::array<int, 2>, 8> kRound = {
        {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
    const auto& at = kRound[static_cast<std::size_t>(k)];
    const Vec3 foot(h * at[0], -h, h * at[1]);
    std::shared_ptr<const SegmentModel>& model = k % 2 == 0 ? straight : diagonal;
    if (model == nullptr) {
      model = make_segment(prism_shape(16, 4, radius, (foot - bottom).norm() / 4), material, settings);
    }
    hang(shape.design.add_row("leg " + std::to_string(k + 1), model, 4, bottom, turn_to_axis(foot - bottom)),
         bottom, foot);
  }
  return shape;
}

CharacterShape eight_part_character(double size, const Material& material, const SegmentSettings& settings) {
  check_positive("eight_part_character: size", size);
  const double block = size / 3, depth = 0.8 * block, radius = depth / 4, limb = 0.5 * block;
  const Vec3 box(block, depth, block);  // left to right, front to back, along the bone
  const BoxPatch left{BoxSide::kLowX, 2, radius}, right{BoxSide::kHighX, 2, radius};
  const BoxPatch back{BoxSide::kHighY, 2, radius};
  const auto belly = make_segment(box_shape({4, 4, 4}, box, {left, right, back}), material, settings);
  const auto chest = make_segment(box_shape({4, 4, 4}, box, {left, right}), material, settings);
  const auto link = make_segment(prism_shape(8, 5, radius, limb), material, settings);

  // z of the torso is up, its y towards the back.
  CharacterShape shape;
  AssemblyDesign& design = shape.design;
  const Vec3 bottom(0, -0.5 * size, 0);
  const Mat3 upright = turn_to_axis(Vec3::UnitY());
  design.parts.push_back({"torso", {belly, chest, chest}, bottom, upright, {}});
  const auto join = [&](const std::string& name, int count, int segment, int interface, const Vec3& out,
                        double reach) {
    const Vec3 root = bottom + (segment + 0.5) * block * Vec3::UnitY() + reach * out;
    const int part = design.add_row(name, link, count, root, turn_to_axis(out));
    design.joins.push_back({{part, false}, {0, segment, interface}});
  };
  join("left leg", 6, 0, 2, -Vec3::UnitX(), 0.5 * block);
  join("right leg", 6, 0, 3, Vec3::UnitX(), 0.5 * block);
  join("tail", 5, 0, 4, -Vec3::UnitZ(), 0.5 * depth);
  join("left arm", 5, 1, 2, -Vec3::UnitX(), 0.5 * block);
  join("right arm", 5, 1, 3, Vec3::UnitX(), 0.5 * block);
  join("left ear", 2, 2, 2, -Vec3::UnitX(), 0.5 * block);
  join("right ear", 2, 2, 3, Vec3::UnitX(), 0.5 * block);

  // As wide as the legs, as high as the torso, as deep as the tail.
  shape.exoskeleton = box_grid(2, 2, 2, Vec3(7 * block, size, 6 * block));
  const auto hang = [&](int part, bool tip) {
    const PartDesign& row = design.parts[static_cast<std::size_t>(part)];
    double length = 0;
    for (const auto& segment : row.segments) {
      const auto at = [&](std::size_t i) {
        return segment->mesh.vertices[static_cast<std::size_t>(segment->interfaces[i].front())];
      };
      length += (at(1) - at(0)).norm();
    }
    const Vec3 end = row.root + (tip ? length : 0.0) * row.rotation.col(2);
    shape.hangings.push_back({{part, tip}, nearest_vertex(shape.exoskeleton, end)});
  };
  hang(0, false);
  hang(0, true);
  for (int part = 1; part <= 5; ++part) hang(part, true);  // the ears stand free
  return shape;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#include "scene_character_parts.h"

#include <algorithm>

#include "scene_body_ref.h"
#include "scene_limits.h"
#include "scene_rigid_reader.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr int kMaxSegments = 1000;  // of a row
constexpr double kMaxStiffness = 1e15, kMaxBoneMass = 1e9, kMaxBoneDamping = 1e12;

class PartsReader {
 public:
  PartsReader(const Scene& scene, CharacterPlan& plan) : scene_(scene), plan_(plan) {
    for (const NamedShape& shape : plan.shapes) shape_names_.push_back(shape.name);
  }

  void read(ObjectReader& item) {
    item.list("parts", {.min = 1, .doc = "rows of segments, each along an unbranched bone"},
              [&](ObjectReader& part, int) { read_part(part); });
    item.list("joins", {.optional = true, .doc = "ends of parts on patches of others"},
              [&](ObjectReader& join, int) { read_join(join); });
    item.list("holds", {.optional = true, .doc = "ends held where they are from the start"},
              [&](ObjectReader& hold, int) {
                HoldPlan held;
                held.end = read_end(hold);
                held.what = read_what(hold);
                plan_.holds.push_back(held);
              });
    const std::string name = item.text(
        "exoskeleton", {.fallback = "", .doc = "name of an elastic body before this one, with attachments"});
    if (item.has("exoskeleton")) {
      const BodyRef body = read_body_ref(item, "exoskeleton", scene_, true, "");
      plan_.exoskeleton = body.index;
      if (scene_.deformables[static_cast<std::size_t>(body.index)].plugin != "elastic") {
        item.refuse("exoskeleton", "permitted is a body of the plugin elastic");
      }
    }
    item.list("attachments", {.optional = true, .doc = "ends hung on vertices of the exoskeleton"},
              [&](ObjectReader& attachment, int) { read_attachment(attachment); });
  }

 private:
  void read_part(ObjectReader& item) {
    PartPlan part;
    part.design.name = item.text("name", {.doc = "for joins, holds, attachments and events"});
    if (std::find(part_names_.begin(), part_names_.end(), part.design.name) != part_names_.end()) {
      item.refuse("name", "another part has it too; permitted are unique names");
    }
    item.list("segments", {.min = 1, .doc = "from the root to the tip"}, [&](ObjectReader& row, int) {
      const std::string shape = row.text("shape", {.doc = "name of a shape"});
      const int count = row.integer(
          "count",
          {.low = 1, .high = kMaxSegments, .fallback = 1, .doc = "so many of it, one after another"});
      part.shapes.insert(part.shapes.end(), static_cast<std::size_t>(count),
                         find_name(row, "shape", shape, shape_names_));
    });
    part.design.root = item.vec3("root", {.quantity = Quantity::kLength,
                                          .low = -kMaxPlace,
                                          .high = kMaxPlace,
                                          .fallback = Vec3(Vec3::Zero()),
                                          .doc = "where the bone begins, in the body's frame"});
    const Vec3 axis = item.vec3("axis", {.low = -kMaxDirection,
                                         .high = kMaxDirection,
                                         .fallback = Vec3(Vec3::UnitZ()),
                                         .doc = "where it leads; need not be a unit vector"});
    const double roll = item.number("roll", {.quantity = Quantity::kAngle,
                                             .low = -kMaxAngle,
                                             .high = kMaxAngle,
                                             .fallback = 0.0,
                                             .doc = "of the segments about it"});
    if (!item.describing()) {
      if (!(axis.norm() > 0.0)) item.refuse("axis", "permitted is any length but 0");
      part.design.rotation = elastic::turn_to_axis(axis, roll);
    }
    item.optional_object("bone", "the paper's own forces on it, (5) and (6); without them the segments alone",
                         [&](ObjectReader& bone) { read_bone(bone, part.design.bone); });
    part.color = read_color(item);
    part_names_.push_back(part.design.name);
    plan_.parts.push_back(std::move(part));
  }

  static void read_bone(ObjectReader& item, elastic::BoneSettings& bone) {
    bone.length_stiffness = item.number("length_stiffness", {.quantity = Quantity::kSpringConstant,
                                                             .low = 0.0,
                                                             .high = kMaxStiffness,
                                                             .fallback = 0.0,
                                                             .doc = "of each bone"});
    bone.angle_stiffness =
        item.number("angle_stiffness",
                    {.low = 0.0, .high = kMaxStiffness, .fallback = 0.0, .doc = "N m/rad, of each joint"});
    bone.mass = item.number("mass", {.quantity = Quantity::kMass,
                                     .low = 0.0,
                                     .high = kMaxBoneMass,
                                     .fallback = 0.0,
                                     .doc = "of each joint"});
    bone.damping = item.number("damping", {.quantity = Quantity::kDamping,
                                           .low = 0.0,
                                           .high = kMaxBoneDamping,
                                           .fallback = 0.0,
                                           .doc = "of each joint against its own velocity"});
  }

  elastic::PartEnd read_end(ObjectReader& item) {
    elastic::PartEnd end;
    const std::string part = item.text("part", {.doc = "name of a part"});
    end.part = find_name(item, "part", part, part_names_);
    end.tip = item.choice<bool>("end", {{"root", false}, {"tip", true}}, {.doc = "of its bone"});
    return end;
  }

  static elastic::Hold read_what(ObjectReader& item) {
    return item.choice<elastic::Hold>(
        "by", {{"surface", elastic::Hold::kSurface}, {"point", elastic::Hold::kPoint}},
        {.fallback = "surface", .doc = "point: the end of the bone alone, round which the surface may turn"});
  }

  void read_join(ObjectReader& item) {
    elastic::Join join;
    join.end = read_end(item);
    const std::string to = item.text("to", {.doc = "name of the part with the patch"});
    join.patch.part = find_name(item, "to", to, part_names_);
    const std::size_t segments =
        item.describing() ? 1 : plan_.parts[static_cast<std::size_t>(join.patch.part)].shapes.size();
    join.patch.segment = item.integer(
        "segment",
        {.low = 0, .high = kMaxSegments * 100, .fallback = 0, .doc = "of that part, from the root"});
    const std::string patch = item.text("patch", {.doc = "name of a patch of that segment's shape"});
    if (!item.describing()) {
      if (join.patch.segment >= static_cast<int>(segments)) {
        item.refuse("segment", "permitted is 0 to " + std::to_string(segments - 1));
      }
      const int shape = plan_.parts[static_cast<std::size_t>(join.patch.part)]
                            .shapes[static_cast<std::size_t>(join.patch.segment)];
      join.patch.interface =
          2 + find_name(item, "patch", patch, plan_.shapes[static_cast<std::size_t>(shape)].patches);
      plan_.joins.push_back(join);
    }
  }

  void read_attachment(ObjectReader& item) {
    AttachmentPlan attachment;
    attachment.end = read_end(item);
    const int count = item.describing() || plan_.exoskeleton < 0
                          ? std::numeric_limits<int>::max()
                          : scene_.deformables[static_cast<std::size_t>(plan_.exoskeleton)].vertex_count;
    attachment.vertex = item.optional_integer(
        "vertex",
        {.low = 0, .high = count - 1, .doc = "counted from 0; or near; or the one nearest to the end"});
    attachment.near = item.optional_vec3("near", {.quantity = Quantity::kLength,
                                                  .low = -kMaxPlace,
                                                  .high = kMaxPlace,
                                                  .doc = "the vertex nearest to this position in the world"});
    if (!item.describing()) {
      if (plan_.exoskeleton < 0) item.refuse("without an exoskeleton; permitted with the key exoskeleton");
      if (attachment.vertex && attachment.near) item.refuse("permitted is one of: vertex, near");
      if (plan_.settings.inertia) item.refuse("permitted where inertia is false");
    }
    plan_.attachments.push_back(attachment);
  }

  const Scene& scene_;
  CharacterPlan& plan_;
  std::vector<std::string> shape_names_, part_names_;
};

// As make_segment_model leaves them, but for what takes time.
std::vector<std::shared_ptr<const elastic::SegmentModel>> outlines(const CharacterPlan& plan) {
  std::vector<std::shared_ptr<const elastic::SegmentModel>> models;
  for (const NamedShape& named : plan.shapes) {
    auto model = std::make_shared<elastic::SegmentModel>();
    model->mesh = named.shape.mesh;
    model->interfaces = named.shape.interfaces;
    models.push_back(std::move(model));
  }
  return models;
}

}  // namespace

elastic::AssemblyDesign design_of(const CharacterPlan& plan,
                                  const std::vector<std::shared_ptr<const elastic::SegmentModel>>& models) {
  elastic::AssemblyDesign design;
  for (const PartPlan& part : plan.parts) {
    design.parts.push_back(part.design);
    for (const int shape : part.shapes) {
      design.parts.back().segments.push_back(models[static_cast<std::size_t>(shape)]);
    }
  }
  design.joins = plan.joins;
  return design;
}

int count_points(const CharacterPlan& plan) {
  std::size_t count = 0;
  for (const PartPlan& part : plan.parts) {
    for (std::size_t s = 0; s < part.shapes.size(); ++s) {
      const elastic::SegmentShape& shape = plan.shapes[static_cast<std::size_t>(part.shapes[s])].shape;
      count += shape.mesh.vertices.size() - (s > 0 ? shape.interfaces.front().size() : 0);
    }
  }
  for (const elastic::Join& join : plan.joins) {
    const PartPlan& part = plan.parts[static_cast<std::size_t>(join.end.part)];
    const int shape = join.end.tip ? part.shapes.back() : part.shapes.front();
    count -= plan.shapes[static_cast<std::size_t>(shape)].shape.interfaces[join.end.tip ? 1 : 0].size();
  }
  return static_cast<int>(count);
}

void read_parts(ObjectReader& item, const Scene& scene, CharacterPlan& plan) {
  PartsReader(scene, plan).read(item);
  if (item.describing()) {
    return;
  }
  try {
    check(design_of(plan, outlines(plan)));
  } catch (const Error& error) {
    item.refuse(error.what());
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene.h"
#include "scene_character_shapes.h"
#include "softpoint/elastic/character.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A part as a scene states it: what stands in a PartDesign, segments by their shapes.
struct PartPlan {
  elastic::PartDesign design;  // without segments
  std::vector<int> shapes;     // of its segments, root to tip
  std::optional<Rgb> color;
};

// What holds an end from the start: nothing but the scene, or a vertex of the exoskeleton.
struct HoldPlan {
  elastic::PartEnd end;
  elastic::Hold what = elastic::Hold::kSurface;
};

struct AttachmentPlan {
  elastic::PartEnd end;
  std::optional<int> vertex;
  std::optional<Vec3> near;  // m, world; neither: nearest to the end
};

// All keys of a character but its material.
struct CharacterPlan {
  std::vector<NamedShape> shapes;
  std::vector<PartPlan> parts;
  std::vector<elastic::Join> joins;
  std::vector<HoldPlan> holds;
  int exoskeleton = -1;  // index among the scene's deformables
  std::vector<AttachmentPlan> attachments;
  elastic::CharacterSettings settings;
  elastic::Material material;
};

// Parts, joins, holds and attachments; plan.shapes is known. Refuses what does not fit together.
void read_parts(ObjectReader& item, const Scene& scene, CharacterPlan& plan);

// The design, its segments being `models` by shape.
elastic::AssemblyDesign design_of(const CharacterPlan& plan,
                                  const std::vector<std::shared_ptr<const elastic::SegmentModel>>& models);

// Points of the character's skin.
int count_points(const CharacterPlan& plan);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

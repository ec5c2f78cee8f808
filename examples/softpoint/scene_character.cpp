#include "scene_character.h"

#include <limits>
#include <utility>

#include "character_actor.h"
#include "scene_character_parts.h"
#include "scene_character_shapes.h"
#include "scene_material.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr double kMaxKappa = 1e15;  // m/N

void read_joints(ObjectReader& item, elastic::AssemblySettings& joints) {
  joints.method = item.choice<elastic::JointMethod>(
      "method",
      {{"equilibrium", elastic::JointMethod::kEquilibrium},
       {"richardson", elastic::JointMethod::kRichardson}},
      {.fallback = "equilibrium", .doc = "richardson: the paper's equation (4), max_iterations times"});
  joints.tolerance =
      item.number("tolerance", {.low = 1e-14,
                                .high = 1.0,
                                .fallback = joints.tolerance,
                                .doc = "what may be left over, as a share of the joint forces"});
  joints.max_iterations = item.integer(
      "max_iterations", {.low = 0, .high = 100000, .fallback = joints.max_iterations, .doc = "a frame"});
  joints.kappa = item.number("kappa", {.low = 0.0,
                                       .high = kMaxKappa,
                                       .fallback = 0.0,
                                       .doc = "m/N, of (4); 0: half the limit of its convergence"});
  joints.predictor =
      item.choice<elastic::Predictor>("predictor",
                                      {{"automatic", elastic::Predictor::kAutomatic},
                                       {"inverse_kinematics", elastic::Predictor::kInverseKinematics},
                                       {"none", elastic::Predictor::kNone}},
                                      {.fallback = "automatic", .doc = "where joints begin"});
  joints.ik_sweeps = item.integer(
      "ik_sweeps",
      {.low = 0, .high = 1000, .fallback = joints.ik_sweeps, .doc = "of cyclic coordinate descent"});
  joints.single_precision = item.choice<bool>(
      "precision", {{"single", true}, {"double", false}},
      {.fallback = "single", .doc = "of the segments' products; all the rest is in double"});
  joints.surface_turns =
      item.boolean("surface_turns",
                   {.fallback = false,
                    .doc = "segments that bend or twist far answer as shorter ones would; twice the time"});
}

void read_settings(ObjectReader& item, elastic::CharacterSettings& settings) {
  settings.inertia =
      item.boolean("inertia", {.fallback = false,
                               .doc = "segments have mass and move by themselves; else they are in "
                                      "balance at every moment, as in the paper"});
  settings.weight = item.boolean("weight", {.fallback = true, .doc = "gravity bends the segments"});
  settings.reaction =
      item.boolean("reaction", {.fallback = true, .doc = "the exoskeleton feels the parts that hang on it"});
  item.optional_object("joints", "how joining surfaces find their place: the accuracy dial",
                       [&](ObjectReader& joints) { read_joints(joints, settings.joints); });
}

// Why an end cannot be held by an event; "" if it can.
std::vector<std::string> taken_ends(const CharacterPlan& plan) {
  std::vector<std::string> taken(2 * plan.parts.size());
  const auto at = [&](const elastic::PartEnd& end) -> std::string& {
    return taken[static_cast<std::size_t>(2 * end.part + (end.tip ? 1 : 0))];
  };
  for (const elastic::Join& join : plan.joins) at(join.end) = "is joined to a patch";
  for (const AttachmentPlan& attachment : plan.attachments) at(attachment.end) = "hangs on the exoskeleton";
  return taken;
}

DeformablePlan read_character(ObjectReader& item, const Scene& scene) {
  CharacterPlan character;
  character.material = read_material(item);
  read_settings(item, character.settings);
  character.shapes = read_segment_shapes(item);
  read_parts(item, scene, character);
  DeformablePlan plan;
  if (item.describing()) {
    return plan;
  }
  plan.vertex_count = count_points(character);
  for (const PartPlan& part : character.parts) plan.parts.push_back(part.design.name);
  plan.taken_ends = taken_ends(character);
  for (const HoldPlan& hold : character.holds) {
    if (const std::string& why =
            plan.taken_ends[static_cast<std::size_t>(2 * hold.end.part + (hold.end.tip ? 1 : 0))];
        !why.empty()) {
      item.refuse("holds", "an end of \"" + plan.parts[static_cast<std::size_t>(hold.end.part)] + "\" " +
                               why + "; permitted are free ends");
    }
  }
  plan.make = [character = std::move(character)](const MakeContext& context) {
    return make_character(character, context);
  };
  return plan;
}

}  // namespace

DeformablePlugin character_plugin() {
  return {"character", "elastic segments joined to limbs and characters", {}, read_character};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

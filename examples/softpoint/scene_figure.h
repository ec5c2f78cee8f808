#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "json_reader.h"
#include "softpoint/figure/figure_animation.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

struct RigidBodySpec;

// Joints given to dynamics, or back to the animation, while a scene is played.
struct HandOver {
  double time = 0;  // s
  int limb = 0;     // the link whose joint it is, with all that hangs on it
  bool dynamic = true;
};

// A keyframed figure of a scene.
struct FigureSpec {
  std::string name;
  std::optional<Vec3> color;
  std::shared_ptr<const figure::FigureModel> model;
  figure::FigureClip clip;
  figure::AnimationSettings settings;
  std::vector<HandOver> hand_overs;  // by time
};

// Reads one of "figures". Of `surroundings`, the scene's rigid bodies, it can touch those that never move.
FigureSpec read_figure(ObjectReader& item, const std::vector<RigidBodySpec>& surroundings,
                       const Vec3& gravity);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

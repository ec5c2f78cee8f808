#pragma once

#include "scene_figure.h"
#include "softpoint/figure/articulated_controller.h"

class btDiscreteDynamicsWorld;

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A keyframed figure in play: its whole animation is made beforehand, then goes through the world.
class FigureActor {
 public:
  FigureActor(const FigureSpec& spec, btDiscreteDynamicsWorld& world);

  const figure::FigureAnimation& animation() const { return animation_; }
  const figure::ArticulatedController& controller() const { return *controller_; }
  // Gives over what the scene gives over up to this time (s).
  void hand_over_until(double time);
  double seconds() const { return seconds_; }  // that making the animation took
  // Of all of it, as it is published now: m, m/s.
  Vec3 center() const;
  Vec3 velocity() const;

 private:
  std::shared_ptr<const figure::FigureModel> model_;
  figure::FigureAnimation animation_;
  std::vector<HandOver> hand_overs_;
  std::size_t next_ = 0;
  double seconds_ = 0;
  std::unique_ptr<figure::ArticulatedController> controller_;
  mutable figure::FigureDynamics placer_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#include "player_figure.h"

#include <chrono>

namespace softpoint::inline SOFTPOINT_ABI::scene {

FigureActor::FigureActor(const FigureSpec& spec, btDiscreteDynamicsWorld& world)
    : model_(spec.model),
      animation_(*spec.model, spec.clip, spec.settings),
      hand_overs_(spec.hand_overs),
      placer_(*spec.model) {
  const auto start = std::chrono::steady_clock::now();
  animation_.evaluate();
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  controller_ = std::make_unique<figure::ArticulatedController>(world, animation_);
}

void FigureActor::hand_over_until(double time) {
  for (; next_ < hand_overs_.size() && hand_overs_[next_].time <= time; ++next_) {
    controller_->hand_over(hand_overs_[next_].limb, hand_overs_[next_].dynamic);
  }
}

Vec3 FigureActor::center() const {
  const figure::FigureState& state = controller_->state();
  placer_.place(state.q.data(), state.qd.data());
  return placer_.mechanics().center_of_mass;
}

Vec3 FigureActor::velocity() const {
  const figure::FigureState& state = controller_->state();
  placer_.place(state.q.data(), state.qd.data());
  return placer_.mechanics().momentum / model_->total_mass();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#pragma once

#include <functional>

#include "paper_cloth.h"
#include "support/cloth_run.h"

namespace softpoint::cloth {

// The task in the `paper` mode; `frames` of it at most.
inline ClothRun paper_lift(const LiftTask& task, const Fabric& fabric, const PaperSettings& settings,
                           int frames = 1 << 30, const std::function<void(const PaperCloth&)>& watch = {}) {
  PaperCloth cloth(reference_pattern(task.columns, fabric), fabric, settings);
  std::vector<Vec3> start = cloth.pattern().points;
  for (Vec3& x : start) x.z() = task.start_height();
  cloth.set_state(start, std::vector<Vec3>(start.size(), Vec3::Zero()));
  cloth.set_gravity({0, 0, -LiftTask::kGravity});
  cloth.set_friction(LiftTask::kFriction);
  cloth.set_air(task.air, LiftTask::kAmbient);
  ClothRun run;
  const auto note = [&](double time) {
    ClothFrame frame = measure_cloth(cloth.pattern(), cloth.positions());
    frame.time = time;
    frame.volume = cloth.volume();
    frame.pressure = LiftTask::kAmbient + cloth.gauge();
    for (int point : task.picked) frame.force += cloth.hand_force(point).z();
    run.push_back(frame);
    if (watch) watch(cloth);
  };
  note(0);
  for (int k = 1; k <= std::min(frames, task.frames()); ++k) {
    const double time = k * LiftTask::kFrame;
    std::vector<PaperHand> hands;
    for (int point : task.picked) {
      hands.push_back({point, start[static_cast<std::size_t>(point)] + Vec3(0, 0, task.lifted(time)),
                       Vec3(0, 0, task.speed(time))});
    }
    cloth.set_hands(hands);
    cloth.step(LiftTask::kFrame);
    note(time);
    if (!std::isfinite(run.back().volume)) break;
  }
  return run;
}

}  // namespace softpoint::cloth

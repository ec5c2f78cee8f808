#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <random>

#include "bubble_finder.h"
#include "cloth_solver.h"
#include "support/cloth_run.h"

namespace softpoint::cloth {

// The solver with a sheet over the plane z = 0, without a world around it.
class SolverSheet {
 public:
  SolverSheet(const ClothPattern& pattern, const Fabric& fabric, const ClothSettings& settings)
      : solver(pattern, fabric, settings),
        fabric_(fabric),
        positions(pattern.points),
        velocities(pattern.points.size(), Vec3::Zero()) {
    solver.set_gravity({0, 0, -LiftTask::kGravity});
  }

  // Where the points begin, at rest.
  void place(const std::vector<Vec3>& start) {
    positions = start;
    solver.set_positions(start);
    solver.set_velocities(velocities);
  }

  // The thesis' bubble: the whole sheet down to the plane, `air` (m3) at ambient pressure.
  void seal(double air) {
    finder.emplace(make_air_topology(solver.pattern().points, solver.pattern().faces), thesis_air(air));
    finder->set_saturation(std::vector<double>(positions.size(), 1.0));
  }

  void step(double dt) {
    if (floor_friction) touch_floor();
    if (finder) find_air();
    solver.set_hands(hands);
    solver.step(dt);
    solver.positions(positions);
    solver.velocities(velocities);
    if (finder && !finder->pockets().empty()) {
      std::vector<double> volumes;
      for (const PocketState& pocket : solver.pockets()) volumes.push_back(pocket.volume);
      finder->exchange(dt, volumes);
    }
  }

  double volume() const { return solver.pockets().empty() ? 0.0 : solver.pockets()[0].volume; }
  double gauge() const { return solver.pockets().empty() ? 0.0 : solver.pockets()[0].gauge; }
  Vec3 floor_force() const {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < solver.point_count(); ++i) sum += solver.mean_contact_force(i);
    return sum;
  }

  ClothSolver solver;
  std::optional<double> floor_friction;
  std::optional<BubbleFinder> finder;
  std::vector<ClothHand> hands;

 private:
  void touch_floor() {
    contacts_.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      contacts_[i].count = 1;
      contacts_[i].planes[0] = {};
      contacts_[i].planes[0].foot = Vec3(positions[i].x(), positions[i].y(), 0);
      contacts_[i].planes[0].friction = *floor_friction;
    }
    solver.set_contacts(contacts_);
  }

  void find_air() {
    feet_ = positions;
    gaps_.resize(positions.size());
    normals_.assign(positions.size(), Vec3::UnitZ());
    for (std::size_t i = 0; i < positions.size(); ++i)
      feet_[i].z() = 0, gaps_[i] = std::max(0.0, positions[i].z());
    finder->find({positions, feet_, normals_, gaps_});
    solver.set_air(finder->face_pockets(), finder->pockets(), finder->rims());
  }

  Fabric fabric_;
  std::vector<Vec3> feet_, normals_;
  std::vector<double> gaps_;
  std::vector<PointContacts> contacts_;

 public:
  std::vector<Vec3> positions, velocities;
};

// The task by the solver; `watch` is called after each frame. The start is up to `shaken` (m) higher or
// lower.
inline ClothRun solver_lift(const LiftTask& task, const ClothSettings& settings,
                            const std::function<void(SolverSheet&, int)>& watch = {}, int frames = 1 << 30,
                            double shaken = 0, unsigned seed = 0) {
  const Fabric fabric = reference_fabric();
  SolverSheet sheet(reference_pattern(task.columns, fabric), fabric, settings);
  std::vector<Vec3> start = sheet.positions;
  for (Vec3& x : start) x.z() = task.start_height();
  std::vector<Vec3> first = start;
  std::mt19937 random(seed);
  for (Vec3& x : first) x.z() += shaken * (2.0 * random() / random.max() - 1.0);
  sheet.place(first);
  sheet.floor_friction = LiftTask::kFriction;
  sheet.seal(task.air);
  ClothRun run;
  run.push_back(measure_cloth(sheet.solver.pattern(), sheet.positions));
  run.back().pressure = task.air > 0 ? LiftTask::kAmbient : 0.0, run.back().volume = task.air;
  for (int k = 1; k <= std::min(frames, task.frames()); ++k) {
    const double time = k * LiftTask::kFrame;
    sheet.hands.clear();
    for (int point : task.picked) {
      sheet.hands.push_back({point, start[static_cast<std::size_t>(point)] + Vec3(0, 0, task.lifted(time)),
                             Vec3(0, 0, task.speed(time)), std::numeric_limits<double>::infinity()});
    }
    sheet.step(LiftTask::kFrame);
    run.push_back(measure_cloth(sheet.solver.pattern(), sheet.positions));
    run.back().time = time;
    run.back().volume = sheet.volume();
    run.back().pressure = LiftTask::kAmbient + sheet.gauge();
    for (std::size_t h = 0; h < sheet.hands.size(); ++h) {
      run.back().force += sheet.solver.hand_force(static_cast<int>(h)).z();
    }
    if (watch) watch(sheet, k);
    if (!std::isfinite(run.back().top)) break;
  }
  return run;
}

}  // namespace softpoint::cloth

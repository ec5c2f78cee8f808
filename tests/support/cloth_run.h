#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "softpoint/cloth/pattern.h"

// Lifts of a wet sheet off the plane z = 0, what is written down of them once a frame, and how far two such
// runs lie apart.
namespace softpoint::cloth {

// One lift: the reference runs' sheet (0.3 m square, 18 g), some of its points moved up by height s^2 (3 - 2
// s), s = t/lift_time, held horizontally, and then held still.
struct LiftTask {
  std::string name;        // of the reference run
  int columns = 50;        // points along each side
  double air = 400e-6;     // m3 at ambient pressure; the sheet begins flat at the height air/area
  double height = 0.1;     // m
  double lift_time = 1;    // s
  double hold_time = 0.2;  // s
  std::vector<int> picked;

  static constexpr double kSide = 0.3, kMass = 0.018, kFrame = 1.0 / 60, kFriction = 0.4, kGravity = 9.8;
  static constexpr double kAmbient = 101325;

  int frames() const { return static_cast<int>(std::lround((lift_time + hold_time) / kFrame)); }
  double start_height() const { return air / (kSide * kSide); }
  double lifted(double time) const {
    const double s = std::clamp(time / lift_time, 0.0, 1.0);
    return height * s * s * (3 - 2 * s);
  }
  double speed(double time) const {
    const double s = time / lift_time;
    return s <= 0 || s >= 1 ? 0.0 : height * 6 * s * (1 - s) / lift_time;
  }
  int point(int i, int j) const { return j * columns + i; }
};

inline LiftTask centre_lift(int columns = 50, double air = 400e-6) {
  LiftTask task;
  task.name = "lift_400cm3_centre";
  task.columns = columns;
  task.air = air;
  task.picked = {task.point(columns / 2, columns / 2)};
  return task;
}
inline LiftTask two_point_lift() {
  LiftTask task = centre_lift();
  task.name = "lift_400cm3_two_points";
  task.picked = {task.point(16, 25), task.point(33, 25)};
  return task;
}
inline LiftTask vacuum_lift() {
  LiftTask task = centre_lift(50, 0);
  task.name = "vacuum_lift_2cm";
  task.height = 0.02, task.lift_time = 0.5, task.hold_time = 0.1;
  return task;
}

// Of the reference runs; C.
inline Fabric reference_fabric() {
  Fabric fabric;
  fabric.area_density = LiftTask::kMass / (LiftTask::kSide * LiftTask::kSide);
  fabric.warp_stiffness = fabric.weft_stiffness = 1e4;
  fabric.shear_stiffness = 2.5e3;
  fabric.compression_ratio = 0.05;
  fabric.damping_time = 1e-4;
  fabric.drag_rate = 1;
  fabric.thickness = 0;
  return fabric;
}
inline ClothPattern reference_pattern(int columns = 50, const Fabric& fabric = reference_fabric()) {
  return square_pattern(columns, columns, LiftTask::kSide, LiftTask::kSide, fabric, Lumping::kEqual);
}

// The columns of the reference files.
struct ClothFrame {
  double time = 0, volume = 0, pressure = 0, force = 0;       // s, m3, Pa, N (sum over the picked points)
  double max_stretch = 0, p99_stretch = 0, mean_stretch = 0;  // of warp and weft; the mean is of sizes
  double top = 0, bottom = 0;                                 // m
};
using ClothRun = std::vector<ClothFrame>;

// Stretch and extent; the rest is the caller's.
inline ClothFrame measure_cloth(const ClothPattern& pattern, const std::vector<Vec3>& x) {
  ClothFrame frame;
  std::vector<double> stretches;
  for (const Spring& s : pattern.springs) {
    if (s.kind != SpringKind::kWarp && s.kind != SpringKind::kWeft) continue;
    stretches.push_back(
        (x[static_cast<std::size_t>(s.b)] - x[static_cast<std::size_t>(s.a)]).norm() / s.rest - 1);
    frame.mean_stretch += std::abs(stretches.back());
  }
  frame.mean_stretch /= static_cast<double>(stretches.size());
  const auto p99 =
      stretches.begin() + static_cast<std::ptrdiff_t>(0.99 * (static_cast<double>(stretches.size()) - 1));
  std::nth_element(stretches.begin(), p99, stretches.end());
  frame.p99_stretch = *p99;
  frame.max_stretch = *std::max_element(stretches.begin(), stretches.end());
  const auto lower = [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); };
  frame.top = std::max_element(x.begin(), x.end(), lower)->z();
  frame.bottom = std::min_element(x.begin(), x.end(), lower)->z();
  return frame;
}

// Reads a run written as the reference files are: one line a frame, the first one a heading.
inline ClothRun read_cloth_run(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  ClothRun run;
  std::string line, cell;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<double> n;
    while (std::getline(cells, cell, ',')) n.push_back(std::atof(cell.c_str()));
    if (n.size() < 10) throw std::runtime_error(path + ": too few columns in: " + line);
    run.push_back({n[1], 1e-6 * n[2], 1e3 * n[3], n[4], n[5], n[6], n[7], n[8], n[9]});
  }
  return run;
}

// How far a run lies from a reference one.
struct ClothErrors {
  double force = 0;        // N: root mean square of differences of means over 0.1 s
  double pressure = 0;     // Pa, root mean square over the frames
  double volume = 0;       // m3, the same
  double p99_stretch = 0;  // of means over 0.1 s, root mean square, in parts of the reference's
  double last_force = 0;   // in parts of the reference's, of the last frame
  double max_stretch = 0;  // largest of the run itself, in any frame
};

template <class Field>
std::vector<double> window_means(const ClothRun& run, std::size_t frames, Field field) {
  constexpr std::size_t kWindow = 6;
  std::vector<double> means;
  for (std::size_t begin = 1; begin + kWindow <= frames; begin += kWindow) {
    double sum = 0;
    for (std::size_t i = begin; i < begin + kWindow; ++i) sum += field(run[i]);
    means.push_back(sum / kWindow);
  }
  return means;
}
inline double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, a.size())));
}

// Of the first frames that both have, the start (frame 0) left out.
inline ClothErrors compare(const ClothRun& run, const ClothRun& reference) {
  ClothErrors errors;
  const std::size_t frames = std::min(run.size(), reference.size());
  const auto force = [](const ClothFrame& f) { return f.force; };
  const auto p99 = [](const ClothFrame& f) { return f.p99_stretch; };
  errors.force = rms_difference(window_means(run, frames, force), window_means(reference, frames, force));
  const std::vector<double> stretch = window_means(reference, frames, p99);
  errors.p99_stretch = rms_difference(window_means(run, frames, p99), stretch) /
                       std::max(1e-300, rms_difference(stretch, std::vector<double>(stretch.size(), 0.0)));
  double volume = 0, pressure = 0;
  for (std::size_t i = 1; i < frames; ++i) {
    volume += std::pow(run[i].volume - reference[i].volume, 2);
    pressure += std::pow(run[i].pressure - reference[i].pressure, 2);
  }
  const double count = static_cast<double>(std::max<std::size_t>(2, frames) - 1);
  errors.volume = std::sqrt(volume / count), errors.pressure = std::sqrt(pressure / count);
  errors.last_force = std::abs(run[frames - 1].force / reference[frames - 1].force - 1);
  for (const ClothFrame& frame : run) errors.max_stretch = std::max(errors.max_stretch, frame.max_stretch);
  return errors;
}

}  // namespace softpoint::cloth

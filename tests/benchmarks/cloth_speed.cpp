// Table 4.2 of the wet-cloth thesis measured anew, and what a frame costs by the number of points.
//   build/bin/cloth_speed [--quick] OUT_PREFIX
// The thesis draws one step of 1/12000 s a picture: its frames a second are beside our time of one such step
// (its scheme with spheres, scalar) and of a whole frame of 1/60 s by the solver at its default. The sheet is
// lifted at its centre as in tests/cloth/data, 400 cm3 of air under it. CPU time of this thread, medians.
#include <cstdio>
#include <cstring>
#include <fstream>

#include "benchmarks/thread_time.h"
#include "softpoint/core/instruction_set.h"
#include "support/paper_lift.h"
#include "support/solver_sheet.h"

namespace softpoint::benchmarks {
namespace {

using namespace softpoint::cloth;

struct Size {
  int columns;
  double thesis_frames;  // a second on its Core i7 3930K; 0: not in its table
};
constexpr Size kSizes[] = {{10, 1720}, {20, 500}, {30, 210}, {40, 115}, {50, 64},
                           {70, 0},    {100, 0},  {140, 0},  {200, 0}};

double solver_frame(int columns, int frames, double& largest_stretch) {
  std::vector<double> seconds;
  double begin = thread_seconds();
  const ClothRun run = solver_lift(
      centre_lift(columns), settings_of(Dial::kDefault),
      [&](SolverSheet&, int) {
        seconds.push_back(thread_seconds() - begin);
        begin = thread_seconds();
      },
      frames);
  largest_stretch = 0;
  for (const ClothFrame& frame : run) largest_stretch = std::max(largest_stretch, frame.max_stretch);
  return median(seconds);
}

// One step as the thesis takes it, springs weak enough for it to be stable.
double paper_step(int columns, bool simd) {
  PaperSettings settings;
  settings.simd = simd;
  settings.sphere_diameter = 0.6 * LiftTask::kSide / (columns - 1);
  settings.sphere_friction = 0.3;
  Fabric fabric = reference_fabric();
  const double mass = LiftTask::kMass / (columns * columns);
  fabric.warp_stiffness = fabric.weft_stiffness = 0.5 * mass / (settings.step * settings.step);
  fabric.shear_stiffness = fabric.warp_stiffness / 4;
  fabric.damping_time = 0.1 * settings.step;
  PaperCloth cloth(reference_pattern(columns, fabric), fabric, settings);
  cloth.set_air_on(false);
  cloth.step(0.02);
  std::vector<double> seconds;
  for (int k = 0; k < 9; ++k) {
    const double begin = thread_seconds();
    const int steps = cloth.step(20 * settings.step);
    seconds.push_back((thread_seconds() - begin) / steps);
  }
  return median(seconds);
}

int run(const std::string& prefix, bool quick) {
  std::ofstream csv(prefix + ".csv"), json(prefix + ".json");
  csv << "points,thesis_ms_per_step,paper_scalar_ms_per_step,paper_simd_ms_per_step,solver_ms_per_frame,real_"
         "time_factor,"
         "largest_stretch\n";
  json << "{\"instruction_set\": \"" << name(best_instruction_set()) << "\", \"rows\": [\n";
  bool first = true;
  for (const Size& size : kSizes) {
    if (quick && size.columns > 100) continue;
    double stretch = 0;
    const double frame = solver_frame(size.columns, size.columns > 100 ? 30 : 72, stretch);
    const double scalar = paper_step(size.columns, false), simd = paper_step(size.columns, true);
    char line[256], object[512], thesis[32] = "";
    if (size.thesis_frames > 0) std::snprintf(thesis, sizeof thesis, "%.4g", 1e3 / size.thesis_frames);
    std::snprintf(line, sizeof line, "%d,%s,%.4g,%.4g,%.4g,%.4g,%.4g", size.columns * size.columns, thesis,
                  1e3 * scalar, 1e3 * simd, 1e3 * frame, 1 / 60.0 / frame, stretch);
    std::snprintf(
        object, sizeof object,
        "%s  {\"points\": %d, \"thesis_ms_per_step\": %s, \"paper_scalar_ms_per_step\": %.4g, "
        "\"paper_simd_ms_per_step\": %.4g, \"solver_ms_per_frame\": %.4g, \"real_time_factor\": %.4g, "
        "\"largest_stretch\": %.4g}",
        first ? "" : ",\n", size.columns * size.columns, thesis[0] ? thesis : "null", 1e3 * scalar,
        1e3 * simd, 1e3 * frame, 1 / 60.0 / frame, stretch);
    csv << line << '\n';
    json << object;
    std::printf("%s\n", line);
    std::fflush(stdout);
    first = false;
  }
  json << "\n]}\n";
  return 0;
}

}  // namespace
}  // namespace softpoint::benchmarks

int main(int argc, char** argv) {
  std::string prefix;
  bool quick = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      quick = true;
    } else {
      prefix = argv[i];
    }
  }
  if (prefix.empty() || prefix.front() == '-') {
    std::fprintf(stderr, "usage: cloth_speed [--quick] OUT_PREFIX\n");
    return 2;
  }
  return softpoint::benchmarks::run(prefix, quick);
}

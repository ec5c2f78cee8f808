// The elastic-character paper's tables 1 and 2: milliseconds a frame of chains of cylinders and of
// exoskeletons.
//   [SOFTPOINT_MAX_ISA=baseline|avx2|avx512] build/bin/character_speed OUT.json
// Medians of 240 frames, CPU time of this thread; the skin's part is wall time, as the assembly reports it.
#include <Eigen/Geometry>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>

#include "benchmarks/thread_time.h"
#include "softpoint/core/deformable_system.h"
#include "softpoint/core/shapes.h"
#include "softpoint/elastic/assembly.h"
#include "softpoint/elastic/elastic_body.h"
#include "support/worlds.h"

namespace softpoint::benchmarks {
namespace {

using namespace softpoint::elastic;

constexpr int kFrames = 240;
constexpr Material kRubber = {.young = 1e5, .poisson = 0.3};

struct ChainTime {
  double frame = 0, skin = 0, iterations = 0;  // s, s
  double greatest = 0;                         // s, of all frames but the first
};

// One end is led along an arc until the chain is bent by 180 degrees.
ChainTime time_chain(int count, const AssemblySettings& settings) {
  AssemblyDesign design;
  design.add_row("chain", make_prism_segment(16, 4, 0.5, 1.0, kRubber), count);
  Assembly chain(design, settings);
  chain.hold({0, false}, Hold::kSurface);
  chain.hold({0, true}, Hold::kSurface);
  chain.solve();  // factors
  std::vector<double> frame, skin, iterations;
  for (int i = 1; i <= kFrames; ++i) {
    const double angle = std::numbers::pi * i / kFrames, radius = count / angle;
    const double start = thread_seconds();
    chain.move({0, true}, Vec3(radius * (1.0 - std::cos(angle)), 0.0, radius * std::sin(angle)),
               Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix());
    chain.solve();
    frame.push_back(thread_seconds() - start);
    skin.push_back(chain.report().skin_seconds);
    iterations.push_back(chain.report().iterations);
  }
  return {median(frame), median(skin), median(iterations), *std::max_element(frame.begin() + 1, frame.end())};
}

// A spinning cube of cells^3, free of contact; with or without the normals that Bullet's renderers read.
double time_exoskeleton(int cells, bool single, bool normals) {
  ElasticSettings settings;
  settings.single_precision = single;
  const auto model =
      make_elastic_model(box_grid(cells, cells, cells, Vec3(1.0, 1.0, 1.0)), kRubber, settings);
  TestWorld world;
  DeformableSystem soft(*world);
  ElasticBody body(model);
  body.set_velocity(Vec3::Zero(), Vec3(0.3, 1.0, 0.2));
  body.set_mirrored_normals(normals);
  soft.add(body);
  world.step(10);
  std::vector<double> seconds;
  for (int i = 0; i < kFrames; ++i) {
    const double start = thread_seconds();
    world.step();
    seconds.push_back(thread_seconds() - start);
  }
  return median(seconds);
}

int run(const std::string& name) {
  std::ofstream out(name);
  if (!out) {
    std::fprintf(stderr, "character_speed: cannot write %s\n", name.c_str());
    return 1;
  }
  char line[320];
  const auto put = [&](const char* end) {
    out << line << end;
    std::printf("%s\n", line);
    std::fflush(stdout);
  };
  out << "{\n  \"instruction_set\": \"" << elastic::name(best_instruction_set()) << "\",\n  \"chains\": [\n";
  // Joints given: they lie where they are carried, without inverse kinematics.
  AssemblySettings carried = AssemblySettings::budget(0);
  carried.predictor = Predictor::kNone;
  for (int count : {10, 13, 30, 50, 70, 100}) {
    const ChainTime given = time_chain(count, carried);
    const ChainTime bent = time_chain(count, {});
    std::snprintf(line, sizeof line,
                  "    {\"cylinders\": %d, \"joints_given_ms\": %.4f, \"skin_ms\": %.4f, \"bent_ms\": %.4f, "
                  "\"bent_greatest_ms\": %.4f, \"bent_iterations\": %g}",
                  count, 1e3 * given.frame, 1e3 * given.skin, 1e3 * bent.frame, 1e3 * bent.greatest,
                  bent.iterations);
    put(count == 100 ? "\n  ],\n  \"exoskeletons\": [\n" : ",\n");
  }
  for (int cells : {2, 3, 4, 6, 8}) {
    const int vertices = 6 * cells * cells + 2;
    std::snprintf(line, sizeof line,
                  "    {\"vertices\": %d, \"single_ms\": %.4f, \"double_ms\": %.4f, "
                  "\"single_with_normals_ms\": %.4f, \"double_with_normals_ms\": %.4f}",
                  vertices, 1e3 * time_exoskeleton(cells, true, false),
                  1e3 * time_exoskeleton(cells, false, false), 1e3 * time_exoskeleton(cells, true, true),
                  1e3 * time_exoskeleton(cells, false, true));
    put(cells == 8 ? "\n  ]\n}\n" : ",\n");
  }
  return 0;
}

}  // namespace
}  // namespace softpoint::benchmarks

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: character_speed OUT.json\n");
    return 2;
  }
  return softpoint::benchmarks::run(argv[1]);
}

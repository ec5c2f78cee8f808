// Remakes the table of tests/support/whole_bar_reference.h: one whole bar of N cylinders, refined.
//   build/bin/whole_bar_reference PARTS LEVEL...       (7 1 2 3: minutes and 5 GB)
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "benchmarks/whole_bar.h"

namespace {

using namespace softpoint::reference;

constexpr double kPoisson = 0.3;

void print_profile(const RefinedBar& bar, const WholeBar& solved, int parts) {
  std::printf("stretched by 1 m: corner displacement u_x, u_z at z (upper half)\n");
  for (int v = 0; v < bar.mesh.vertex_count(); ++v) {
    const softpoint::Vec3 x = bar.mesh.vertices[v];
    if (std::abs(x.x() - kRadius) > 1e-12 || x.z() < -1e-12) continue;
    std::printf("  %10.7f %12.8f %12.8f\n", x.z() / parts, solved.displacement(3 * v, 0),
                solved.displacement(3 * v + 2, 0));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int parts = argc > 1 ? std::atoi(argv[1]) : 0;
  if (parts < 1 || argc < 3) {
    std::fprintf(stderr, "usage: whole_bar_reference PARTS LEVEL...\n");
    return 2;
  }
  std::printf("%d parts, E = 1 Pa, nu = 0.3, r = 0.5 m, part length 1 m\n", parts);
  std::printf("level vertices        stretch          twist           bend          shear   seconds\n");
  for (int i = 2; i < argc; ++i) {
    const int level = std::atoi(argv[i]);
    if (level < 1) return 2;
    const RefinedBar bar = refined_bar(parts, level);
    const auto start = std::chrono::steady_clock::now();
    const WholeBar solved = solve_whole_bar(bar.mesh, bar.bottom, bar.top, kPoisson);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const BarStiffness& k = solved.stiffness;
    std::printf("%5d %8d %14.10f %14.10f %14.10f %14.10f %9.2f\n", level, bar.mesh.vertex_count(), k.stretch,
                k.twist, k.bend, solved.shear, seconds.count());
    std::fflush(stdout);
    if (i == argc - 1) print_profile(bar, solved, parts);
  }
  return 0;
}

// The time a complete matrix takes, printed by stage. The promise, on one core at the default quadrature:
// 82 vertices 0.1 s, 386 vertices 1 s. Three times that is asserted, for the noise of shared machines.
#include <gtest/gtest.h>

#include <algorithm>

#include "benchmarks/thread_time.h"
#include "elastic_support.h"
#include "support/tier.h"

namespace softpoint::elastic {
namespace {

#if !defined(__OPTIMIZE__)
constexpr double kPatience = 100.0;
#else
constexpr double kPatience = 3.0;
#endif

// Seconds of the processor, of the fastest of some: a machine that others share stretches the clock.
double assemble_and_print(const char* shape, const TriangleMesh& mesh, InstructionSet set, int times = 1) {
  StiffnessSettings settings;
  settings.max_instruction_set = set;
  StiffnessSeconds best;
  best.total = 1e9;
  double fastest = 1e9;
  for (int i = 0; i < times; ++i) {
    const double started = benchmarks::thread_seconds();
    const auto model = assemble_stiffness(mesh, 0.3, settings);
    fastest = std::min(fastest, benchmarks::thread_seconds() - started);
    if (model->instruction_set != set) return 0.0;  // this machine has no such instructions
    if (model->seconds.total < best.total) best = model->seconds;
  }
  std::printf("%-6s %5d %-8s %10.4f %10.4f %12.4f %10.4f %8.4f\n", shape, mesh.vertex_count(), name(set),
              best.quadrature, best.assembly, best.condensation, best.correction, best.total);
  return fastest;
}

TEST(StiffnessSpeed, MeetsTheClock) {
  if (kInstrumented) GTEST_SKIP() << "of time, not of memory";
  std::printf("shape  vertices set     quadrature   assembly condensation correction    total (s)\n");
  const TriangleMesh part = standard_part(), longer = prism(16, 8, 2, 0.5, 1.0),
                     cube = box_grid(8, 8, 8, Vec3(1, 1, 1));
  for (InstructionSet set : {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    assemble_and_print("prism", part, set);
    if (full_tier()) {
      assemble_and_print("prism", longer, set);
      assemble_and_print("cube", cube, set);
      assemble_and_print("prism", prism(32, 16, 4, 0.5, 1.0), set);
    }
  }
  EXPECT_LE(assemble_and_print("prism", part, best_instruction_set(), 3), 0.1 * kPatience);
  EXPECT_LE(assemble_and_print("cube", cube, best_instruction_set(), 3), 1.0 * kPatience);
}

}  // namespace
}  // namespace softpoint::elastic

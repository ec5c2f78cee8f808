// Run time against error of each integrator, with and without limits, against trajectories that several
// engines agree on. figure_accuracy > OUT.csv; plot_figure.py OUT.csv OUT.svg draws it.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "../figure/support.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_stepper.h"
#include "thread_time.h"

namespace softpoint::figure {
namespace {

using benchmarks::thread_seconds;

constexpr Integrator kAll[] = {Integrator::kPaper, Integrator::kRungeKutta4, Integrator::kDormandPrince,
                               Integrator::kVariational};

struct Task {
  const char* name;
  FigureModel model;
  FigureState start;
  std::vector<double> end;  // positions
  double time;              // s
  bool limited;
};

// The spinning humanoid in free flight for a second.
Task humanoid_flight() {
  const auto rows = read_rows("out_own_r3_humanoid_spin.csv");
  const FigureModel model = read_amdl_file(data_file("mjhum27.amdl"));
  std::size_t last = 0;
  while (last + 1 < rows.size() && rows[last][0] < 1 - 1e-9) ++last;
  return {"humanoid in flight; 1 s",           model,         humanoid_state(model, rows[0]),
          humanoid_state(model, rows[last]).q, rows[last][0], false};
}

// A double pendulum that strikes its stops for 3 s.
Task pendulum_with_stops() {
  const auto rows = read_rows("out_own_r6_double_pendulum_limit.csv");
  return {"double pendulum with stops; 3 s",
          read_amdl_file(data_file("pend2_limits.amdl")),
          {{-std::numbers::pi / 2, -0.5}, {0, 0}},
          {rows.back()[1], rows.back()[2]},
          rows.back()[0],
          true};
}

void run(const Task& task) {
  for (const Integrator integrator : kAll) {
    for (int rate = 30; rate <= 3840; rate *= 2) {
      const int steps = static_cast<int>(std::lround(task.time * rate));
      double seconds = 1e9, error = 0;
      for (int repeat = 0; repeat < 5; ++repeat) {
        FigureStepper stepper(task.model, task.start, integrator);
        if (task.limited)
          stepper.set_limits(integrator == Integrator::kPaper ? LimitMode::kPaper : LimitMode::kExact);
        const double from = thread_seconds();
        for (int k = 0; k < steps; ++k) stepper.step(task.time / steps);
        seconds = std::min(seconds, thread_seconds() - from);
        error = 0;
        for (std::size_t i = 0; i < task.end.size(); ++i)
          error = std::max(error, std::abs(stepper.state().q[i] - task.end[i]));
      }
      std::printf("%s,%s,%d,%.3f,%.3e\n", task.name, name(integrator), rate, 1e6 * seconds / task.time,
                  error);
    }
  }
}

}  // namespace
}  // namespace softpoint::figure

int main() {
  std::printf("task,integrator,steps a second,us a simulated second,error\n");
  softpoint::figure::run(softpoint::figure::humanoid_flight());
  softpoint::figure::run(softpoint::figure::pendulum_with_stops());
}

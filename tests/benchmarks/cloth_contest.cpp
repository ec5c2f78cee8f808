// Run time against error of lifted wet cloth: every method and setting lifts the sheets of tests/cloth/data.
//   build/bin/cloth_contest [--quick] [--task NAME] [--method TEXT] OUT_PREFIX
// One row a method, setting and task goes to OUT_PREFIX.csv and OUT_PREFIX.json; plot_cloth.py draws the
// former. Times are CPU time of this thread, the median of the frames; errors are those of cloth_run.h
// against the fine-step runs. The paper's scheme runs with the dampers of the references, whose longest
// stable step is short, and with weaker ones that allow it its longest. --quick leaves out what takes
// minutes.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>

#include "benchmarks/cloth_peer.h"
#include "benchmarks/thread_time.h"
#include "support/paper_lift.h"
#include "support/solver_sheet.h"

namespace softpoint::benchmarks {
namespace {

using namespace softpoint::cloth;

struct Entry {
  std::string method, setting;
  bool slow;
  std::function<TimedRun(const LiftTask&)> lift;
};

TimedRun timed_paper(const LiftTask& task, double damping_time, const PaperSettings& settings) {
  TimedRun timed;
  Fabric fabric = reference_fabric();
  fabric.damping_time = damping_time;
  double begin = thread_seconds();
  timed.run = paper_lift(task, fabric, settings, 1 << 30, [&](const PaperCloth&) {
    timed.seconds.push_back(thread_seconds() - begin);
    begin = thread_seconds();
  });
  timed.seconds.erase(timed.seconds.begin());
  return timed;
}

TimedRun timed_solver(const LiftTask& task, const ClothSettings& settings) {
  TimedRun timed;
  double begin = thread_seconds();
  timed.run = solver_lift(task, settings, [&](SolverSheet&, int) {
    timed.seconds.push_back(thread_seconds() - begin);
    begin = thread_seconds();
  });
  return timed;
}

std::string text(const char* format, double a, double b = 0) {
  char out[96];
  std::snprintf(out, sizeof out, format, a, b);
  return out;
}

std::vector<Entry> entries() {
  std::vector<Entry> all;
  const auto ours = [&all](const std::string& name, const ClothSettings& settings) {
    all.push_back({settings.march_step > 0 ? "softpoint" : "softpoint, sweeps alone", name, false,
                   [settings](const LiftTask& t) { return timed_solver(t, settings); }});
  };
  ours("fast", settings_of(Dial::kFast));
  ours("default", settings_of(Dial::kDefault));
  ours("exact", settings_of(Dial::kExact));
  for (const double step : {1.0 / 10800, 1.0 / 28800}) {
    ClothSettings settings = settings_of(Dial::kDefault);
    settings.march_step = step;
    ours(text("explicit steps of %.0f us", 1e6 * step), settings);
  }
  for (const int substeps : {5, 10, 20, 40, 80, 160}) {
    ClothSettings settings = settings_of(Dial::kDefault);
    settings.march_step = 0;  // sweeps alone
    settings.max_substep = 1.0 / 60 / substeps;
    ours(text("%.0f substeps", substeps), settings);
  }
  const auto paper = [&all](const char* method, bool simd, Precision precision, double damping, double step,
                            bool slow) {
    PaperSettings settings = reference_paper_settings(step);
    settings.simd = simd;
    settings.precision = precision;
    const std::string name = text("step %g us, dampers %g us", 1e6 * step, 1e6 * damping);
    all.push_back({method, name, slow, [=](const LiftTask& t) { return timed_paper(t, damping, settings); }});
  };
  for (const bool simd : {true, false}) {
    for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
      if (!simd && precision == Precision::kSingle) continue;
      const char* method = !simd                             ? "the thesis, scalar"
                           : precision == Precision::kDouble ? "the thesis, SIMD double"
                                                             : "the thesis, SIMD single";
      paper(method, simd, precision, 1e-4, 2.6e-6, true);
      for (const double step : {5e-6, 10e-6, 17e-6, 20e-6})
        paper(method, simd, precision, 5e-6, step, step < 9e-6);
      paper(method, simd, precision, 0, 17e-6, false);
    }
  }
  for (const int iterations : {5, 10, 20, 50}) {
    all.push_back({"btSoftBody, dry", text("%.0f iterations", iterations), iterations > 20,
                   [=](const LiftTask& t) { return bullet_lift(t, iterations, 1); }});
  }
  for (const int substeps : {4, 16}) {
    all.push_back({"btSoftBody, dry", text("10 iterations, %.0f substeps", substeps), substeps > 4,
                   [=](const LiftTask& t) { return bullet_lift(t, 10, substeps); }});
  }
  return all;
}

struct Row {
  std::string task, method, setting;
  std::size_t frames;
  double seconds;
  ClothErrors errors;
};

std::string number(double value, const char* missing) {
  if (!std::isfinite(value)) return missing;
  return text("%.6g", value);
}

void write(const std::vector<Row>& rows, const std::string& prefix) {
  std::ofstream csv(prefix + ".csv"), json(prefix + ".json");
  csv << "task,method,setting,frames,ms_per_frame,force_error_N,pressure_error_Pa,volume_error_cm3,p99_error,"
         "last_force_error,max_stretch\n";
  json << "[\n";
  for (const Row& r : rows) {
    const ClothErrors& e = r.errors;
    const double values[] = {1e3 * r.seconds, e.force,      e.pressure,   1e6 * e.volume,
                             e.p99_stretch,   e.last_force, e.max_stretch};
    const char* keys[] = {"ms_per_frame", "force_error_N",    "pressure_error_Pa", "volume_error_cm3",
                          "p99_error",    "last_force_error", "max_stretch"};
    csv << r.task << ",\"" << r.method << "\",\"" << r.setting << "\"," << r.frames;
    json << "  {\"task\": \"" << r.task << "\", \"method\": \"" << r.method << "\", \"setting\": \""
         << r.setting << "\", \"frames\": " << r.frames;
    for (int k = 0; k < 7; ++k) {
      csv << ',' << number(values[k], "");
      json << ", \"" << keys[k] << "\": " << number(values[k], "null");
    }
    csv << '\n';
    json << (&r == &rows.back() ? "}\n" : "},\n");
  }
  json << "]\n";
}

int run(const std::string& prefix, const std::string& only_task, const std::string& only_method, bool quick) {
  std::vector<Row> rows;
  for (const LiftTask& task : {centre_lift(), two_point_lift(), vacuum_lift()}) {
    if (!only_task.empty() && task.name != only_task) continue;
    const ClothRun reference = read_cloth_run(std::string(SOFTPOINT_CLOTH_DATA) + "/" + task.name + ".csv");
    for (const Entry& entry : entries()) {
      if ((entry.method + " " + entry.setting).find(only_method) == std::string::npos) continue;
      if (quick && entry.slow) continue;
      const bool bullet = entry.method.compare(0, 2, "bt") == 0;
      if (bullet && task.air <= 0) continue;
      const TimedRun timed = entry.lift(task);
      Row row{task.name,
              entry.method,
              entry.setting,
              timed.run.size() - 1,
              median(timed.seconds),
              compare(timed.run, reference)};
      if (timed.run.size() < reference.size()) row.errors.force = INFINITY;               // it burst
      if (bullet) row.errors.force = row.errors.pressure = row.errors.volume = INFINITY;  // it has none
      rows.push_back(row);
      const ClothErrors& e = row.errors;
      std::printf(
          "%-22s %-24s %-28s %3zu %9.3f ms  force %.4f N  p %.2f Pa  V %.4f cm3  p99 %.3f  last %.4f  max "
          "%.4f\n",
          task.name.c_str(), entry.method.c_str(), entry.setting.c_str(), row.frames, 1e3 * row.seconds,
          e.force, e.pressure, 1e6 * e.volume, e.p99_stretch, e.last_force, e.max_stretch);
      std::fflush(stdout);
    }
  }
  write(rows, prefix);
  return 0;
}

}  // namespace
}  // namespace softpoint::benchmarks

int main(int argc, char** argv) {
  std::string prefix, task, method;
  bool quick = false;
  for (int i = 1; i < argc; ++i) {
    const bool more = i + 1 < argc;
    if (std::strcmp(argv[i], "--quick") == 0) {
      quick = true;
    } else if (std::strcmp(argv[i], "--task") == 0 && more) {
      task = argv[++i];
    } else if (std::strcmp(argv[i], "--method") == 0 && more) {
      method = argv[++i];
    } else {
      prefix = argv[i];
    }
  }
  if (prefix.empty() || prefix.front() == '-') {
    std::fprintf(stderr, "usage: cloth_contest [--quick] [--task NAME] [--method TEXT] OUT_PREFIX\n");
    return 2;
  }
  return softpoint::benchmarks::run(prefix, task, method, quick);
}

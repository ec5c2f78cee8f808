// Run time against error of elastic bars: every method and setting does every task.
//   build/bin/bar_contest [--quick] [--parts N] [--task NAME] [--method TEXT] [--amount PART] OUT_PREFIX
// One row a method, setting, task and number of parts goes to OUT_PREFIX.csv and OUT_PREFIX.json;
// plot_contest.py makes a picture of the former. The load grows in 120 frames (24 with --quick, which also
// leaves out more than 200 iterations); methods with inertia are then held until they rest, 240 frames at
// most. --amount takes so much of each load. Times are CPU time of this thread, the median of the frames in
// which the load grows. Errors are those of the last frame: of the force or moment at the end (push: of the
// tip, in parts of the length), and of the positions of the free vertices (root mean square, in parts of the
// answer's); both also against the first contestant, our exact balance, which tells what the dial alone
// costs.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>

#include "benchmarks/bar_task.h"
#include "benchmarks/thread_time.h"

namespace softpoint::benchmarks {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kQuietFrames = 60;
// Settings of more than 200 iterations.
constexpr const char* kLong[] = {"000", "400", "500"};
constexpr double kQuiet = 1e-5;  // of the length: moved less in kQuietFrames is rest

struct Options {
  std::string out, method, task;
  int parts = 0;
  double amount = 1;
  bool quick = false;
  int frames() const { return quick ? 24 : 120; }
  int most_frames() const { return frames() + (quick ? 120 : 240); }
};

struct Row {
  std::string method, setting, task;
  int parts = 0, vertices = 0, frames = 0;
  double seconds = kNan, iterations = 0;
  double end = kNan, position = kNan;          // against the reference
  double own_end = kNan, own_position = kNan;  // against our exact balance on the same mesh
  bool rests = true;
};

struct Exact {
  std::vector<Vec3> vertices;
  double load = kNan;
};

double largest_step(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double step = (a[i] - b[i]).norm();
    if (!(step <= most)) most = step;  // and NaN
  }
  return most;
}

// The load stays; until the bar rests, bursts, or time is up.
void settle(Bar& bar, const BarTask& task, const Options& options, Row& row) {
  std::vector<Vec3> earlier = bar.vertices();
  row.rests = false;
  while (row.frames < options.most_frames() && !row.rests) {
    for (int i = 0; i < kQuietFrames; ++i, ++row.frames) bar.frame(1.0);
    std::vector<Vec3> now = bar.vertices();
    const double step = largest_step(now, earlier);
    if (!std::isfinite(step)) return;
    row.rests = step <= kQuiet * task.length();
    earlier.swap(now);
  }
}

Row compete(const Contestant& contestant, const BarTask& task, const BarAnswer& answer, Bar& bar,
            const Options& options, Exact& exact) {
  Row row = {contestant.method, contestant.setting, task.name, task.parts};
  row.vertices = static_cast<int>(answer.vertices.size());
  std::vector<double> seconds, iterations;
  for (; row.frames < options.frames(); ++row.frames) {
    const double start = thread_seconds();
    bar.frame((row.frames + 1.0) / options.frames());
    seconds.push_back(thread_seconds() - start);
    iterations.push_back(bar.iterations());
  }
  row.seconds = median(seconds);
  row.iterations = median(iterations);
  if (bar.has_inertia()) settle(bar, task, options, row);
  const std::vector<Vec3> x = bar.vertices();
  row.end = end_error(task, bar, answer);
  row.position = position_error(task, x, answer.vertices);
  if (exact.vertices.empty()) exact = {x, end_load(task, bar)};
  row.own_position = position_error(task, x, exact.vertices);
  row.own_end = task.is_held() ? std::abs(end_load(task, bar) / exact.load - 1.0)
                               : (x.back() - exact.vertices.back()).norm() / task.length();
  return row;
}

std::string number(double value, const char* missing) {
  if (!std::isfinite(value)) return missing;
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

void write(const std::vector<Row>& rows, const std::string& name) {
  std::ofstream csv(name + ".csv"), json(name + ".json");
  csv << "method,setting,task,parts,vertices,frames,rests,seconds_per_frame,iterations,end_error,position_"
         "error,"
         "end_error_of_dial,position_error_of_dial\n";
  json << "[\n";
  for (const Row& r : rows) {
    csv << '"' << r.method << "\",\"" << r.setting << "\"," << r.task << ',' << r.parts << ',' << r.vertices
        << ',' << r.frames << ',' << r.rests << ',' << number(r.seconds, "") << ',' << r.iterations << ','
        << number(r.end, "") << ',' << number(r.position, "") << ',' << number(r.own_end, "") << ','
        << number(r.own_position, "") << '\n';
    json << "  {\"method\": \"" << r.method << "\", \"setting\": \"" << r.setting << "\", \"task\": \""
         << r.task << "\", \"parts\": " << r.parts << ", \"vertices\": " << r.vertices
         << ", \"frames\": " << r.frames << ", \"rests\": " << (r.rests ? "true" : "false")
         << ", \"seconds_per_frame\": " << number(r.seconds, "null") << ", \"iterations\": " << r.iterations
         << ", \"end_error\": " << number(r.end, "null")
         << ", \"position_error\": " << number(r.position, "null")
         << ", \"end_error_of_dial\": " << number(r.own_end, "null")
         << ", \"position_error_of_dial\": " << number(r.own_position, "null") << '}'
         << (&r == &rows.back() ? "\n" : ",\n");
  }
  json << "]\n";
}

void print(const Row& r) {
  std::printf(
      "%-14s %-36s %-8s %3d %5d%c %10.4f ms %6g it  end %9.4f %%  position %9.4f %%  dial %.1e %.1e\n",
      r.method.c_str(), r.setting.c_str(), r.task.c_str(), r.parts, r.frames, r.rests ? ' ' : '+',
      1e3 * r.seconds, r.iterations, 100 * r.end, 100 * r.position, r.own_end, r.own_position);
  std::fflush(stdout);
}

int run(const Options& options) {
  std::vector<Contestant> contestants;
  for (auto* group :
       {&assembly_contestants, &collocation_contestants, &spring_contestants, &tetrahedra_contestants}) {
    for (Contestant& c : (*group)()) contestants.push_back(std::move(c));
  }
  std::vector<Row> rows;
  for (int parts : {7, 13}) {
    if (options.parts != 0 && options.parts != parts) continue;
    for (BarTask task : all_tasks(parts)) {
      task.amount *= options.amount;
      if (!options.task.empty() && task.name != options.task) continue;
      const BarAnswer answer = reference_answer(task);
      Exact exact;
      for (const Contestant& contestant : contestants) {
        const bool first = &contestant == &contestants.front();
        if (!first &&
            (contestant.method + " " + contestant.setting).find(options.method) == std::string::npos) {
          continue;
        }
        const bool long_one = std::any_of(std::begin(kLong), std::end(kLong), [&](const char* text) {
          return contestant.setting.find(text) != std::string::npos;
        });
        if (options.quick && long_one) continue;
        const std::unique_ptr<Bar> bar = contestant.make(task);
        if (!bar) continue;
        rows.push_back(compete(contestant, task, answer, *bar, options, exact));
        print(rows.back());
      }
    }
  }
  write(rows, options.out);
  return 0;
}

}  // namespace
}  // namespace softpoint::benchmarks

int main(int argc, char** argv) {
  softpoint::benchmarks::Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    const bool more = i + 1 < argc;
    if (key == "--quick") {
      options.quick = true;
    } else if (key == "--parts" && more) {
      options.parts = std::atoi(argv[++i]);
    } else if (key == "--task" && more) {
      options.task = argv[++i];
    } else if (key == "--method" && more) {
      options.method = argv[++i];
    } else if (key == "--amount" && more) {
      options.amount = std::atof(argv[++i]);
    } else {
      options.out = key;
    }
  }
  if (options.out.empty() || options.out.front() == '-') {
    std::fprintf(stderr,
                 "usage: bar_contest [--quick] [--parts N] [--task NAME] [--method TEXT] [--amount PART] "
                 "OUT_PREFIX\n");
    return 2;
  }
  return softpoint::benchmarks::run(options);
}

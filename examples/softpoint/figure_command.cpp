#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "command.h"
#include "figure_joints.h"
#include "figure_prescription.h"
#include "figure_state_file.h"
#include "figure_trace.h"
#include "softpoint/core/atomic_file.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/bvh.h"
#include "softpoint/figure/urdf.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using figure::FigureModel;
using figure::FigureState;
using figure::FigureStepper;
using figure::Integrator;
using figure::JointKind;
using figure::LimitMode;

constexpr Integrator kIntegrators[] = {Integrator::kPaper, Integrator::kRungeKutta4,
                                       Integrator::kDormandPrince, Integrator::kVariational};
constexpr LimitMode kLimitModes[] = {LimitMode::kNone, LimitMode::kPaper, LimitMode::kExact};
constexpr long long kMaxSteps = 1'000'000'000, kMaxRows = 10'000'000;

struct FigureOptions {
  std::string model, base, state, dynamic, prescribe, trace, bvh;
  double time = 0, step = 0, scale = 1;
  std::string integrator = "rk4", limits = "none";
  std::vector<double> gravity = {0, 0, -9.81};
  long long every = 1;
};

template <class Value, std::size_t Count>
std::vector<std::string> names_of(const Value (&values)[Count]) {
  std::vector<std::string> names;
  for (const Value value : values) names.emplace_back(name(value));
  return names;
}

// Known to be one of them.
template <class Value, std::size_t Count>
Value named(const Value (&values)[Count], const std::string& text) {
  return *std::find_if(std::begin(values), std::end(values),
                       [&](Value value) { return text == name(value); });
}

// One flag a link: dynamic. Without --dynamic all that the file does not prescribe.
std::unique_ptr<bool[]> chosen_joints(const FigureOptions& options, const FigureModel& model,
                                      const std::vector<int>& prescribed) {
  const auto links = static_cast<std::size_t>(model.link_count());
  auto flags = std::make_unique<bool[]>(links);
  const bool all = options.dynamic.empty() || options.dynamic == "all";
  std::fill_n(flags.get(), links, all);
  for (const int link : prescribed) flags[static_cast<std::size_t>(link)] = false;
  if (all && (options.dynamic.empty() || prescribed.empty())) return flags;
  if (all) {
    throw Error(
        fmt::format("--dynamic all: '{}' is in the file of --prescribe; permitted are the other joints",
                    model.joint_name(prescribed[0])));
  }
  if (options.dynamic == "none") return flags;
  std::size_t begin = 0;
  while (begin <= options.dynamic.size()) {
    const std::size_t end = std::min(options.dynamic.find(',', begin), options.dynamic.size());
    const std::string joint = options.dynamic.substr(begin, end - begin);
    const int link = find_joint(model, joint, "--dynamic");
    if (std::find(prescribed.begin(), prescribed.end(), link) != prescribed.end()) {
      throw Error(
          fmt::format("--dynamic '{}' is in the file of --prescribe; permitted are the other joints", joint));
    }
    flags[static_cast<std::size_t>(link)] = true;
    begin = end + 1;
  }
  return flags;
}

// What is neither dynamic nor prescribed stands where it is.
void hold_others(const FigureModel& model, const bool* dynamic, FigureState& state) {
  for (int i = 0; i < model.link_count(); ++i) {
    if (dynamic[i]) continue;
    const figure::Link& link = model.links()[static_cast<std::size_t>(i)];
    double* rates = state.qd.data() + model.velocity_offset(i);
    const int count = velocity_count(link.joint);
    if (std::any_of(rates, rates + count, [](double rate) { return rate != 0; })) {
      fmt::print(stderr, "joint '{}' is held: its velocity in the state is not used\n", model.joint_name(i));
    }
    std::fill_n(rates, count, 0.0);
  }
}

// Whole steps, and a shorter one if the time is no multiple of them.
struct Course {
  long long steps;
  double last;  // s, of the last step
};

Course course_of(const FigureOptions& options) {
  const double ratio = options.time / options.step;
  if (ratio > static_cast<double>(kMaxSteps)) {
    throw Error(fmt::format("--step {}: {} steps; permitted are {}", to_text(options.step), to_text(ratio),
                            kMaxSteps));
  }
  const auto whole = static_cast<long long>(ratio * (1 + 1e-12));
  const double rest = options.time - static_cast<double>(whole) * options.step;
  const bool has_rest = rest >= std::max(1e-9, 1e-9 * options.step);
  const Course course{whole + has_rest, has_rest ? rest : options.step};
  if (course.steps / options.every > kMaxRows) {
    throw Error(fmt::format("--every {}: {} rows of the trace; permitted are {}", options.every,
                            course.steps / options.every, kMaxRows));
  }
  return course;
}

FigureModel model_of(const FigureOptions& options) {
  const std::string extension = std::filesystem::path(options.model).extension();
  const bool urdf = extension == ".urdf";
  if (!urdf && !options.base.empty()) {
    throw Error(fmt::format("--base {}: {} says itself how it stands; permitted with a .urdf", options.base,
                            options.model));
  }
  if (urdf && options.scale == 1) {
    return figure::read_urdf_file(options.model, options.base == "free"    ? figure::UrdfBase::kFree
                                                 : options.base == "fixed" ? figure::UrdfBase::kFixed
                                                                           : figure::UrdfBase::kAuto);
  }
  if (extension == ".bvh") {
    figure::BvhFigureSettings settings;
    settings.scale = options.scale;
    return figure::bvh_figure(figure::read_bvh_file(options.model), settings);
  }
  if (options.scale != 1) {
    throw Error(fmt::format("--scale {}: {} is in metres; permitted with a .bvh", to_text(options.scale),
                            options.model));
  }
  return figure::read_amdl_file(options.model);
}

std::optional<FigurePrescription> prescription_of(const FigureOptions& options, const FigureModel& model) {
  if (options.prescribe.empty()) return std::nullopt;
  FigurePrescription motion = read_figure_prescription(options.prescribe, model);
  const double slack = 1e-9 * (1 + options.time);
  if (motion.first_time() > slack || motion.last_time() < options.time - slack) {
    throw Error(fmt::format("{}: times from {} to {} s; permitted are rows that cover 0 to {} s",
                            options.prescribe, to_text(motion.first_time()), to_text(motion.last_time()),
                            to_text(options.time)));
  }
  return motion;
}

FigureState start_of(const FigureOptions& options, const FigureModel& model, const bool* dynamic,
                     const FigurePrescription* motion) {
  FigureState state = options.state.empty() ? rest_state(model) : read_figure_state(options.state, model);
  if (motion == nullptr) {
    hold_others(model, dynamic, state);
    return state;
  }
  for (const int link : motion->links()) {  // the file has these, whatever the state says
    std::fill_n(state.qd.begin() + model.velocity_offset(link),
                velocity_count(model.links()[static_cast<std::size_t>(link)].joint), 0.0);
  }
  hold_others(model, dynamic, state);
  std::vector<double> accelerations(state.qd.size());
  motion->evaluate(0, state.q.data(), state.qd.data(), accelerations.data());
  return state;
}

void report(const FigureOptions& options, FigureStepper& stepper, long long steps, double energy) {
  const FigureModel& model = stepper.dynamics().model();
  const figure::LimitCounts& counts = stepper.limit_counts();
  fmt::print("{}: {} links, {} degrees of freedom, {} steps, energy {:.9g} to {:.9g} J", options.trace,
             model.link_count(), model.velocity_count(), steps, energy, stepper.energy());
  if (stepper.limits() == LimitMode::kExact) {
    fmt::print(", {} impacts, {} releases", counts.impacts, counts.releases);
  } else if (stepper.limits() == LimitMode::kPaper) {
    fmt::print(", {} joints held by a pull, {} steps unfinished", counts.wrong_sign, counts.unfinished);
  }
  fmt::print("\n");
}

int run_figure(const FigureOptions& options) {
  for (const std::string& file : {options.trace, options.bvh}) {
    if (!file.empty()) check_writable(file);
  }
  const Course course = course_of(options);
  const FigureModel model = model_of(options);
  const std::optional<FigurePrescription> motion = prescription_of(options, model);
  const auto dynamic = chosen_joints(options, model, motion ? motion->links() : std::vector<int>());

  FigureStepper stepper(model, start_of(options, model, dynamic.get(), motion ? &*motion : nullptr),
                        named(kIntegrators, options.integrator));
  stepper.dynamics().set_gravity({options.gravity[0], options.gravity[1], options.gravity[2]});
  stepper.set_dynamic({dynamic.get(), static_cast<std::size_t>(model.link_count())});
  if (motion) stepper.set_prescribed_motion(&*motion);
  stepper.set_limits(named(kLimitModes, options.limits));

  FigureTrace trace(model);
  figure::BvhRecorder clip(
      model, std::min(1000.0, std::max(1e-6, options.step * static_cast<double>(options.every))));
  const auto record = [&](double t) {
    trace.add(t, stepper);
    if (!options.bvh.empty()) clip.add(stepper.state().q.data());
  };
  record(0);
  const double energy = stepper.energy();
  double time = 0;
  for (long long i = 1; i <= course.steps; ++i) {
    const bool last = i == course.steps;
    if (!stepper.step(last ? course.last : options.step)) {
      write_atomically(options.trace, trace.csv());
      throw Error(
          fmt::format("{}: after t = {} s numbers are no longer finite; permitted are smaller steps than "
                      "--step {}",
                      options.model, to_text(time), to_text(options.step)));
    }
    time = last ? options.time : static_cast<double>(i) * options.step;
    stepper.set_time(time);  // no sum of roundings
    if (i % options.every == 0 || last) record(time);
  }
  write_atomically(options.trace, trace.csv());
  if (!options.bvh.empty()) write_atomically(options.bvh, figure::bvh_text(clip.clip()));
  report(options, stepper, course.steps, energy);
  return kExitDone;
}

}  // namespace

Command add_figure_command(CLI::App& program) {
  auto options = std::make_shared<FigureOptions>();
  CLI::App* app = program.add_subcommand("figure", "Integrate one articulated figure, without a scene");
  app->add_option("MODEL", options->model, "Figure (.amdl, .urdf; .bvh: a skeleton)")->required();
  app->add_option("--base", options->base, "Root of a .urdf; if absent free if it has a mass")
      ->check(CLI::IsMember({"free", "fixed"}));
  app->add_option("--scale", options->scale, "Metres a unit of a .bvh; 1 if absent")
      ->check(CLI::Range(1e-6, 1e6));
  app->add_option("--state", options->state, "Start (JSON); at rest if absent");
  app->add_option("--dynamic", options->dynamic,
                  "Joints left to dynamics: JOINT,... or all or none; if absent all but the prescribed ones");
  app->add_option("--prescribe", options->prescribe, "Motion of joints (CSV: t,<joint>,...)");
  app->add_option("--time", options->time, "Seconds to integrate")->required()->check(CLI::Range(0.0, 1e6));
  app->add_option("--step", options->step, "Seconds a step")->required()->check(CLI::Range(1e-9, 1.0));
  app->add_option("--integrator", options->integrator, "rk4 if absent")
      ->check(CLI::IsMember(names_of(kIntegrators)));
  app->add_option("--limits", options->limits, "How ranges of joints are kept; none if absent")
      ->check(CLI::IsMember(names_of(kLimitModes)));
  app->add_option("--gravity", options->gravity, "X,Y,Z in m/s2; 0,0,-9.81 if absent")
      ->delimiter(',')
      ->expected(3);
  app->add_option("--trace", options->trace, "Motion (CSV)")->required();
  app->add_option("--bvh", options->bvh,
                  "The rows of the trace as a motion too, for animation programs (BVH)");
  app->add_option("--every", options->every, "Steps a row of the trace")
      ->check(CLI::Range(1LL, 1'000'000'000LL));
  return {app, [options] { return run_figure(*options); }};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

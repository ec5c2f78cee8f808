#include "metrics_recorder.h"

#include <sys/utsname.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <thread>

#include "metrics_figure.h"
#include "sibling.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using nlohmann::ordered_json;

ordered_json list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

// The smallest value that a share `p` of all do not exceed (nearest rank).
double percentile(const std::vector<double>& sorted, double p) {
  const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

ordered_json statistics(std::vector<double> values) {
  if (values.empty()) {
    return nullptr;
  }
  std::sort(values.begin(), values.end());
  return {{"p10", percentile(values, 0.10)},
          {"p50", percentile(values, 0.50)},
          {"p90", percentile(values, 0.90)},
          {"p99", percentile(values, 0.99)},
          {"max", values.back()},
          {"mean", std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size())}};
}

ordered_json energies(const MechanicalState& state) {
  return {{"kinetic", state.kinetic},
          {"elastic", state.elastic},
          {"potential", state.potential},
          {"total", state.energy()}};
}

ordered_json depth_json(const Depth& depth) {
  ordered_json result = {{"depth", depth.depth}};
  if (depth.depth > 0.0) {
    result["frame"] = depth.frame;
    result["deformable"] = depth.deformable;
    result["rigid"] = depth.rigid;
    result["point"] = depth.point;
  }
  return result;
}

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (const auto colon = line.find(": "); line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown";
}

ordered_json machine() {
  utsname system = {};
  uname(&system);
  return {{"processor", processor()},
          {"threads", std::thread::hardware_concurrency()},
          {"system", std::string(system.sysname) + " " + system.release + " " + system.machine}};
}

}  // namespace

MetricsRecorder::MetricsRecorder(Player& player)
    : player_(player),
      first_frame_(player.frame()),
      start_(measure_state(player)),
      now_(start_),
      articulations_(player),
      sheets_(player) {
  largest_energy_ = least_energy_ = start_.energy();
}

void MetricsRecorder::record() {
  now_ = measure_state(player_);
  largest_momentum_change_ = std::max(largest_momentum_change_, (now_.momentum - start_.momentum).norm());
  largest_angular_momentum_change_ =
      std::max(largest_angular_momentum_change_, (now_.angular_momentum - start_.angular_momentum).norm());
  largest_energy_ = std::max(largest_energy_, now_.energy());
  least_energy_ = std::min(least_energy_, now_.energy());

  const Penetration penetration = measure_penetration(player_);
  penetration_.vertex.take(penetration.vertex);
  penetration_.corner.take(penetration.corner);

  articulations_.record();
  sheets_.record();

  const FrameWork& work = player_.work();
  seconds_.step.push_back(work.step_seconds);
  seconds_.predict.push_back(work.seconds.predict);
  seconds_.detect.push_back(work.seconds.detect);
  seconds_.compliance.push_back(work.seconds.compliance);
  seconds_.solve.push_back(work.seconds.solve);
  seconds_.commit.push_back(work.seconds.commit);
  seconds_.mirror.push_back(work.seconds.mirror);
  seconds_.rest.push_back(work.step_seconds - work.seconds.total());
  const auto count = [&](long long FrameWork::*field) {
    sum_.*field += work.*field;
    largest_.*field = std::max(largest_.*field, work.*field);
  };
  for (const auto field :
       {&FrameWork::contacts, &FrameWork::passes, &FrameWork::iterations, &FrameWork::pairs,
        &FrameWork::pairs_skipped, &FrameWork::without_pairs, &FrameWork::without_contacts}) {
    count(field);
  }
}

std::string MetricsRecorder::json() const {
  const WorldSpec& world = player_.scene().world;
  const int frames = player_.frame() - first_frame_;
  const double simulated = frames * world.time_step;
  const double wall = std::accumulate(seconds_.step.begin(), seconds_.step.end(), 0.0);
  const Profile::Totals& totals = player_.system().profile().totals;
  const auto count = [&](long long FrameWork::*field) {
    return ordered_json{{"total", sum_.*field}, {"largest", largest_.*field}};
  };
  ordered_json result;
  result["scene"] = player_.scene().file;
  result["precision"] = kBuiltPrecision == Precision::kDouble ? "double" : "single";
  result["machine"] = machine();
  result["frames"] = frames;
  result["time_step"] = world.time_step;
  result["substeps"] = world.substeps;
  result["simulated_seconds"] = simulated;
  result["step_seconds_total"] = wall;
  result["real_time_factor"] = wall > 0.0 ? ordered_json(simulated / wall) : ordered_json(nullptr);
  result["step_seconds"] = statistics(seconds_.step);
  result["stage_seconds"] = {
      {"predict", statistics(seconds_.predict)},       {"detect", statistics(seconds_.detect)},
      {"compliance", statistics(seconds_.compliance)}, {"solve", statistics(seconds_.solve)},
      {"commit", statistics(seconds_.commit)},         {"mirror", statistics(seconds_.mirror)},
      {"bullet", statistics(seconds_.rest)},
  };
  result["energy"] = {{"start", energies(start_)},
                      {"end", energies(now_)},
                      {"largest_total", largest_energy_},
                      {"least_total", least_energy_}};
  result["momentum"] = {{"start", list(start_.momentum)},
                        {"end", list(now_.momentum)},
                        {"largest_change", largest_momentum_change_},
                        {"scale_at_start", start_.momentum_scale}};
  result["angular_momentum"] = {{"start", list(start_.angular_momentum)},
                                {"end", list(now_.angular_momentum)},
                                {"largest_change", largest_angular_momentum_change_}};
  result["penetration"] = {{"vertex_in_rigid", depth_json(penetration_.vertex)},
                           {"corner_in_skin", depth_json(penetration_.corner)}};
  if (ordered_json characters = articulations_.json(); !characters.empty()) {
    result["characters"] = std::move(characters);
  }
  if (ordered_json cloths = sheets_.json(); !cloths.empty()) {
    result["cloths"] = std::move(cloths);
  }
  if (ordered_json figures = figures_json(player_); !figures.empty()) {
    result["figures"] = std::move(figures);
  }
  result["counts"] = {{"deformables", player_.deformable_count()},
                      {"rigid_bodies", player_.rigid_count()},
                      {"contacts", count(&FrameWork::contacts)},
                      {"passes", count(&FrameWork::passes)},
                      {"iterations", count(&FrameWork::iterations)},
                      {"pairs", count(&FrameWork::pairs)},
                      {"pairs_skipped", count(&FrameWork::pairs_skipped)},
                      {"detections_skipped", count(&FrameWork::without_pairs)},
                      {"responses_skipped", count(&FrameWork::without_contacts)}};
  result["substeps_total"] = totals.substeps;
  result["guard_fired"] = totals.guard_fired;
  result["late_substeps"] = totals.late_substeps;
  result["refactorizations"] = totals.refactorizations;
  return result.dump(2) + "\n";
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

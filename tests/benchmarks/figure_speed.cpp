// figure_speed [OUT.json]: microseconds of a forward dynamics of the humanoid and of chains, ours and other
// engines' taken in turns in one run; of crowds by instruction set; of whole steps by integrator.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <string>

#include "benchmarks/figure_peers.h"
#include "benchmarks/thread_time.h"
#include "figure/support.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_crowd.h"
#include "softpoint/figure/figure_dynamics.h"
#include "softpoint/figure/figure_stepper.h"

namespace softpoint::benchmarks {
#ifndef SOFTPOINT_HAVE_MUJOCO
std::unique_ptr<FigurePeer> mujoco_peer(const figure::FigureModel&, const figure::FigureState&, bool) {
  return nullptr;
}
#endif
#ifndef SOFTPOINT_HAVE_DART
std::unique_ptr<FigurePeer> dart_peer(const figure::FigureModel&, const figure::FigureState&) {
  return nullptr;
}
#endif
#ifndef SOFTPOINT_HAVE_SIMBODY
std::unique_ptr<FigurePeer> simbody_peer(const figure::FigureModel&, const figure::FigureState&) {
  return nullptr;
}
#endif
namespace {

using namespace figure;

struct Contender {
  std::string name;
  std::function<void()> run;
  double per_call = 1;  // figures
  double best = 1e300;  // s a figure
};

// Least of many short runs, the contenders in turns: what else the machine does then hits all alike.
void race(std::vector<Contender>& contenders) {
  for (int round = 0; round < 60; ++round) {
    for (Contender& c : contenders) {
      int calls = 0;
      const double start = thread_seconds();
      double now = start;
      for (; now - start < 2e-3; now = thread_seconds()) {
        for (int k = 0; k < 20; ++k) c.run();
        calls += 20;
      }
      c.best = std::min(c.best, (now - start) / (calls * c.per_call));
    }
  }
}

std::string g_json;

void report(const std::string& task, const std::vector<Contender>& contenders) {
  for (const Contender& c : contenders) {
    std::printf("%-22s %-36s %10.3f us  %6.2f of the first\n", task.c_str(), c.name.c_str(), 1e6 * c.best,
                c.best / contenders[0].best);
    char line[300];
    std::snprintf(line, sizeof line, "%s\n    {\"task\": \"%s\", \"engine\": \"%s\", \"microseconds\": %.4g}",
                  g_json.empty() ? "" : ",", task.c_str(), c.name.c_str(), 1e6 * c.best);
    g_json += line;
  }
}

FigureModel chain(int links) {
  std::vector<Link> result;
  for (int i = 0; i < links; ++i) {
    Link link;
    link.name = "rod" + std::to_string(i);
    link.parent = i - 1;
    link.axis = i % 2 == 0 ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY());
    link.origin = i == 0 ? Vec3(Vec3::Zero()) : Vec3(0, 0, 0.1);
    set_cylinder(link, 0.5, 0.02, 0.1);
    result.push_back(link);
  }
  return FigureModel(result);
}

FigureState moving(const FigureModel& model, double size) {
  FigureState state = rest_state(model);
  RandomFigures random(1);
  for (int i = 0; i < model.link_count(); ++i) {
    if (model.links()[static_cast<std::size_t>(i)].joint != JointKind::kHinge) continue;
    state.q[static_cast<std::size_t>(model.position_offset(i))] = size * random.vector().x();
  }
  for (double& v : state.qd) v = random.vector().x();
  return state;
}

void engines(const std::string& task, const FigureModel& model) {
  const FigureState state = moving(model, 0.3);
  FigureDynamics ours(model);
  std::vector<double> qdd(state.qd.size());
  std::vector<std::unique_ptr<FigurePeer>> peers;
  peers.push_back(multibody_peer(model, state));
  for (const bool whole : {false, true}) {
    if (model.link_count() <= 30) peers.push_back(mujoco_peer(model, state, whole));  // deeper XML it refuses
  }
  peers.push_back(dart_peer(model, state));
  peers.push_back(simbody_peer(model, state));
  std::vector<Contender> contenders;
  contenders.push_back(
      {"softpoint", [&] { ours.forward(state.q.data(), state.qd.data(), nullptr, qdd.data()); }});
  FigureDynamics paper(model);
  paper.set_method(ForwardMethod::kMatrix);
  std::vector<double> unused(qdd);
  if (model.link_count() <= 100) {
    contenders.push_back({"softpoint, the paper's H and B",
                          [&] { paper.forward(state.q.data(), state.qd.data(), nullptr, unused.data()); }});
  }
  for (auto& peer : peers) {
    if (peer) contenders.push_back({peer->name(), [&peer] { peer->forward(); }});
  }
  race(contenders);
  report(task, contenders);
  double largest = 0;
  for (const double a : qdd) largest = std::max(largest, std::abs(a));
  std::printf("  softpoint: largest acceleration %g\n", largest);
  for (auto& peer : peers) {
    if (peer)
      std::printf("  %s: largest acceleration %g\n", peer->name().c_str(), peer->largest_acceleration());
  }
}

void crowds(const FigureModel& model) {
  std::vector<std::unique_ptr<FigureCrowd>> kept;
  std::vector<Contender> contenders;
  const FigureState state = moving(model, 0.3);
  FigureDynamics alone(model);
  std::vector<double> qdd(state.qd.size());
  contenders.push_back(
      {"alone", [&] { alone.forward(state.q.data(), state.qd.data(), nullptr, qdd.data()); }});
  for (const InstructionSet set :
       {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    if (choose_instruction_set(set) != set) continue;
    kept.push_back(std::make_unique<FigureCrowd>(model, 64, set));
    for (int i = 0; i < 64; ++i) kept.back()->set_state(i, state.q, state.qd);
    FigureCrowd& crowd = *kept.back();
    contenders.push_back({std::string("crowd of 64, ") + name(set), [&crowd] { crowd.forward(); }, 64});
  }
  race(contenders);
  report("humanoid, 27 dof", contenders);
}

void steps(const FigureModel& model) {
  std::vector<Contender> contenders;
  std::vector<std::unique_ptr<FigureStepper>> kept;
  const FigureState state = moving(model, 0.1);
  for (const Integrator integrator :
       {Integrator::kPaper, Integrator::kRungeKutta4, Integrator::kDormandPrince, Integrator::kVariational}) {
    kept.push_back(std::make_unique<FigureStepper>(model, state, integrator));
    FigureStepper& stepper = *kept.back();
    contenders.push_back({std::string("step, ") + name(integrator), [&stepper, &state] {
                            stepper.step(1.0 / 240);
                            if (stepper.time() > 0.2) {
                              stepper.set_state(state);
                              stepper.set_time(0);
                            }
                          }});
  }
  race(contenders);
  report("humanoid, 1/240 s", contenders);
}

}  // namespace
}  // namespace softpoint::benchmarks

int main(int argc, char** argv) {
  using namespace softpoint;
  const figure::FigureModel humanoid = figure::read_amdl_file(figure::data_file("mjhum27.amdl"));
  std::vector<figure::Link> links = humanoid.links();
  for (figure::Link& link : links) link.armature = 0.01;
  benchmarks::engines("humanoid, 27 dof", humanoid);
  for (const int n : {10, 30, 100, 1000}) {
    benchmarks::engines("chain of " + std::to_string(n), benchmarks::chain(n));
  }
  benchmarks::crowds(humanoid);
  benchmarks::steps(figure::FigureModel(links));
  if (argc > 1) {
    std::string machine = "unknown", line;
    std::ifstream info("/proc/cpuinfo");
    while (std::getline(info, line)) {
      if (line.rfind("model name", 0) == 0) machine = line.substr(line.find(':') + 2);
    }
    std::ofstream(argv[1]) << "{\n  \"machine\": \"" << machine << "\",\n  \"results\": ["
                           << benchmarks::g_json << "\n  ]\n}\n";
  }
}

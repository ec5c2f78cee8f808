// Softpoint's assembly as a bar, from one iteration a frame to the exact balance, and the paper's equation
// (4) as its named mode.
#include <algorithm>

#include "benchmarks/bar_task.h"
#include "softpoint/elastic/assembly.h"

namespace softpoint::benchmarks {
namespace {

using elastic::Assembly;
using elastic::AssemblyDesign;
using elastic::AssemblySettings;
using elastic::Hold;
using elastic::SegmentModel;

const std::shared_ptr<const SegmentModel>& cylinder() {
  static const auto model =
      elastic::make_prism_segment(reference::kSides, 4, reference::kRadius, reference::kPartLength,
                                  {.young = kYoung, .poisson = kPoisson});
  return model;
}

AssemblyDesign row_of(int parts) {
  AssemblyDesign design;
  design.add_row("bar", cylinder(), parts, Vec3(0.0, 0.0, -0.5 * parts * reference::kPartLength));
  return design;
}

class AssemblyBar : public Bar {
 public:
  AssemblyBar(const BarTask& task, const AssemblySettings& settings)
      : task_(task), assembly_(row_of(task.parts), settings) {
    assembly_.hold({0, false}, Hold::kSurface);
    if (task.is_held()) assembly_.hold({0, true}, Hold::kSurface);
    const int rings = 4 * task.parts + 1, last = task.parts - 1;
    points_.push_back(assembly_.point_of({0, 0, 0}));
    for (int ring = 0; ring < rings; ++ring) {
      const int segment = std::min(ring / 4, last);
      for (int k = 0; k < reference::kSides; ++k) {
        const int vertex = 1 + (ring - 4 * segment) * reference::kSides + k;
        points_.push_back(assembly_.point_of({0, segment, vertex}));
      }
    }
    points_.push_back(assembly_.point_of({0, last, cylinder()->mesh.vertex_count() - 1}));
  }

  void frame(double load) override {
    if (task_.is_held()) {
      const EndPose pose = task_.pose(load);
      assembly_.move({0, true}, Vec3(0.0, 0.0, 0.5 * task_.length()) + pose.shift, pose.rotation());
    } else {
      push(task_.force(load));
    }
    assembly_.solve();
  }

  std::vector<Vec3> vertices() const override {
    std::vector<Vec3> result;
    for (int at : points_) result.push_back(assembly_.points()[static_cast<std::size_t>(at)]);
    return result;
  }
  std::optional<Vec3> end_force() const override { return assembly_.force({0, true}); }
  std::optional<Vec3> end_moment() const override { return assembly_.moment({0, true}); }
  double iterations() const override { return assembly_.report().iterations; }

 private:
  // Spread evenly over the cap: a third to its centre.
  void push(const Vec3& force) {
    const int last = task_.parts - 1, centre = cylinder()->mesh.vertex_count() - 1;
    assembly_.push({0, last, centre}, force / 3.0);
    for (int k = 1; k <= reference::kSides; ++k) {
      assembly_.push({0, last, centre - k}, force * (2.0 / 3.0 / reference::kSides));
    }
  }

  BarTask task_;
  Assembly assembly_;
  std::vector<int> points_;  // of the skin, in the order of bar_mesh
};

}  // namespace

std::vector<Contestant> assembly_contestants() {
  std::vector<Contestant> result;
  const auto add = [&](const std::string& method, const std::string& setting,
                       const AssemblySettings& settings) {
    result.push_back({method, setting, [settings](const BarTask& task) -> std::unique_ptr<Bar> {
                        return std::make_unique<AssemblyBar>(task, settings);
                      }});
  };
  AssemblySettings balance = AssemblySettings::exact();
  balance.surface_turns = false;
  add("softpoint", "balance 1e-10", balance);
  add("softpoint, surfaces turned", "exact", AssemblySettings::exact());
  for (int n : {0, 1, 2, 4, 8, 16}) {
    add("softpoint", std::to_string(n) + " iterations", AssemblySettings::budget(n));
  }
  const std::pair<const char*, double> tolerances[] = {
      {"1e-2", 1e-2}, {"1e-3", 1e-3}, {"1e-4", 1e-4}, {"1e-6", 1e-6}};
  for (const auto& [text, value] : tolerances) {
    for (const bool single : {true, false}) {
      AssemblySettings s;
      s.tolerance = value;
      s.single_precision = single;
      s.max_iterations = value < 1e-3 ? 100 : AssemblySettings{}.max_iterations;
      add("softpoint", std::string("tolerance ") + text + (single ? "" : ", double"), s);
      s.surface_turns = true;
      if (single) add("softpoint, surfaces turned", std::string("tolerance ") + text, s);
    }
  }
  for (int n : {10, 100, 1000, 10000}) {
    AssemblySettings s = AssemblySettings::budget(n);
    s.method = elastic::JointMethod::kRichardson;
    add("softpoint, (4)", std::to_string(n) + " iterations", s);
  }
  return result;
}

}  // namespace softpoint::benchmarks

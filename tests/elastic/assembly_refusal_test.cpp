// Whatever is out of range is refused by name, and nothing has changed then.
#include <gtest/gtest.h>

#include <functional>

#include "elastic_support.h"
#include "softpoint/core/limits.h"
#include "softpoint/core/state_archive.h"
#include "softpoint/elastic/assembly.h"
#include "support/characters.h"
#include "support/field_table.h"
#include "support/refusal.h"

namespace softpoint::elastic {
namespace {

// A pulled chain of these settings has finite numbers.
bool works(const AssemblyDesign& design, const AssemblySettings& settings = {}) {
  Assembly chain(design, settings);
  chain.hold(kRoot, Hold::kSurface);
  chain.hold(kTip, Hold::kPoint);
  chain.move(kTip, chain.bone(0).back() + Vec3(0.2, 0.1, 0.1));
  chain.solve();
  return all_finite(chain.points()) && chain.force(kTip).allFinite() && std::isfinite(chain.energy());
}

Fields fields_of(BoneSettings& bone) {
  auto& [length_stiffness, angle_stiffness, mass, damping] = bone;
  return {{"length_stiffness", length_stiffness, 0, 1e15},
          {"angle_stiffness", angle_stiffness, 0, 1e15},
          {"mass", mass, 0, 1e9},
          {"damping", damping, 0, 1e12}};
}

Fields fields_of(AssemblySettings& settings) {
  auto& [method, tolerance, max_iterations, kappa, predictor, ik_sweeps, single, instruction_set,
         surface_turns] = settings;
  static_assert(std::is_same_v<decltype(method), JointMethod>);              // tried below
  static_assert(std::is_same_v<decltype(predictor), Predictor>);             // tried below
  static_assert(std::is_same_v<decltype(instruction_set), InstructionSet>);  // tried below
  static_assert(std::is_same_v<decltype(single), bool>);
  static_assert(std::is_same_v<decltype(surface_turns), bool>);
  return {{"AssemblySettings.tolerance", tolerance, 1e-14, 1.0},
          {"AssemblySettings.max_iterations", max_iterations, 0, 100000},
          {"AssemblySettings.kappa", kappa, 0, 1e300},
          {"AssemblySettings.ik_sweeps", ik_sweeps, 0, 1000}};
}

TEST(AssemblyRefuses, EveryFieldOfABone) {
  expect_every_field<BoneSettings>(
      {100, 10, 0, 0}, [](BoneSettings& s) { return fields_of(s); },
      [](const BoneSettings& bone) { return works(chain_of(2, cylinder_segment(), bone)); });
}

TEST(AssemblyRefuses, EveryFieldOfItsSettings) {
  expect_every_field<AssemblySettings>(
      {}, [](AssemblySettings& s) { return fields_of(s); },
      [](const AssemblySettings& settings) { return works(chain_of(2), settings); });
}

TEST(AssemblyRefuses, SettingsThatComeLaterAndKeepsThoseItHas) {
  Assembly chain(chain_of(2));
  const auto state = [&] {
    const AssemblySettings& s = chain.settings();
    return to_text(s.tolerance) + " " + std::to_string(s.max_iterations) + " " + to_text(s.kappa) + " " +
           std::to_string(s.ik_sweeps) + " " + std::to_string(static_cast<int>(s.method)) + " " +
           std::to_string(static_cast<int>(s.predictor));
  };
  expect_every_field<AssemblySettings>(
      {}, [](AssemblySettings& s) { return fields_of(s); },
      [&](const AssemblySettings& settings) {
        chain.set_settings(settings);
        return true;
      },
      [&] { return state(); });
  const std::string before = state();
  for (const int bad : {-1, 2, 77}) {
    AssemblySettings settings;
    settings.method = static_cast<JointMethod>(bad);
    expect_refusal([&] { chain.set_settings(settings); }, {"AssemblySettings.method", std::to_string(bad)});
  }
  for (const int bad : {-1, 3, 77}) {
    AssemblySettings settings;
    settings.predictor = static_cast<Predictor>(bad);
    expect_refusal([&] { chain.set_settings(settings); },
                   {"AssemblySettings.predictor", std::to_string(bad)});
    settings = {};
    settings.max_instruction_set = static_cast<InstructionSet>(bad);
    expect_refusal([&] { chain.set_settings(settings); },
                   {"AssemblySettings.max_instruction_set", std::to_string(bad)});
    expect_refusal([&] { Assembly(chain_of(1), settings); }, {"AssemblySettings.max_instruction_set"});
  }
  EXPECT_EQ(state(), before);
  // Precision stays as it was made.
  AssemblySettings exact = AssemblySettings::exact();
  chain.set_settings(exact);
  EXPECT_TRUE(chain.settings().single_precision);
}

TEST(AssemblyRefuses, EveryFieldOfAPart) {
  expect_every_field<Vec3>(
      Vec3::Zero(),
      [](Vec3& root) {
        Fields fields;
        add_fields(fields, "root", root, -kMaxPosition, kMaxPosition);
        return fields;
      },
      [](const Vec3& root) {
        AssemblyDesign design = chain_of(2);
        design.parts[0].root = root;
        check(design);
        return true;
      });
  for (int entry = 0; entry < 9; ++entry) {
    for (const double value : {kNotANumber, kUnbounded, -1.0, 2.0, 1e300}) {
      AssemblyDesign design = chain_of(2);
      design.parts[0].rotation(entry / 3, entry % 3) = value;
      expect_refusal([&] { check(design); }, {"parts[0] 'chain'.rotation", "permitted"});
      Mat3 rotation = Mat3::Identity();
      rotation(entry / 3, entry % 3) = value;
      expect_refusal([&] { Assembly(chain_of(1), {}, Vec3::Zero(), rotation); }, {"rotation", "permitted"});
    }
  }
  expect_refusal([] { Assembly(chain_of(1), {}, Vec3::Zero(), Mat3(-Mat3::Identity())); }, {"rotation"});
  expect_refusal([] { Assembly(chain_of(1), {}, Vec3(0, kNotANumber, 0)); }, {"origin", "permitted"});
  for (const int count : {0, -1, 100001}) {
    AssemblyDesign design;
    expect_refusal([&] { design.add_row("", cylinder_segment(), count); },
                   {"add_row: count", std::to_string(count), "permitted"});
    EXPECT_TRUE(design.parts.empty());
  }
}

TEST(AssemblyRefuses, DesignsThatDoNotFit) {
  expect_refusal([] { check(AssemblyDesign{}); }, {"parts is empty", "permitted"});
  AssemblyDesign design = chain_of(1);
  design.parts[0].segments.clear();
  expect_refusal([&] { check(design); }, {"parts[0] 'chain'.segments is empty"});
  design.parts[0].segments = {nullptr};
  expect_refusal([&] { check(design); }, {"parts[0] 'chain'.segments[0] is null"});
  design.parts[0].segments = {
      make_segment_model(prism(16, 4, 1, 0.5, 1.0), {{0, 1, 2, 3}}, {}, with_shared_cache())};
  expect_refusal([&] { check(design); }, {"segments[0] has one interface"});
  // Caps of different sizes, and of different numbers of vertices.
  design.parts[0].segments = {cylinder_segment(), cylinder_segment(1e5, 4, 1.0, 0.6)};
  expect_refusal([&] { check(design); }, {"parts[0].segments[1]", "joining surface", "permitted"});
  design.parts[0].segments = {cylinder_segment(), limb_segment()};
  expect_refusal([&] { check(design); }, {"parts[0].segments[1]", "17", "9", "permitted"});
}

TEST(AssemblyRefuses, JoinsThatDoNotFit) {
  const auto refused = [](const std::function<void(std::vector<Join>&)>& change,
                          const std::vector<std::string>& fragments) {
    AssemblyDesign design = branched_figure();
    change(design.joins);
    expect_refusal([&] { check(design); }, fragments);
  };
  for (const int bad : {-1, 3, 2147483647}) {
    refused([&](auto& joins) { joins[1].end.part = bad; }, {"joins[1].end.part", std::to_string(bad)});
    refused([&](auto& joins) { joins[0].patch.part = bad; }, {"joins[0].patch.part", std::to_string(bad)});
    refused([&](auto& joins) { joins[0].patch.segment = bad; },
            {"joins[0].patch.segment", std::to_string(bad)});
  }
  for (const int bad : {-1, 0, 1, 4}) {
    refused([&](auto& joins) { joins[1].patch.interface = bad; },
            {"joins[1].patch.interface", std::to_string(bad)});
  }
  refused([](auto& joins) { joins[0].end.part = 0; }, {"joins[0]", "to itself"});
  refused([](auto& joins) { joins[1] = joins[0]; }, {"joins[1]", "joined already"});
  refused([](auto& joins) { joins[1].patch = joins[0].patch; }, {"joins[1]", "joined already"});
  refused([](auto& joins) { std::swap(joins[0].patch, joins[1].patch); }, {"joins", "permitted"});  // apart
}

// What an assembly is after a solve: of all its points, its tip's force and holder.
std::uint64_t state_of(Assembly& chain) {
  chain.solve();
  std::uint64_t hash = state_hash(chain.points().data(), chain.points().size() * sizeof(Vec3));
  const Vec3 force = chain.force(kTip);
  const Hold hold = chain.held(kTip);
  return state_hash(&hold, sizeof hold, state_hash(&force, sizeof force, hash));
}

TEST(AssemblyRefuses, BadHandsAndPushesAndStaysAsItIs) {
  Assembly chain(chain_of(3), AssemblySettings::exact());
  chain.hold(kRoot, Hold::kSurface);
  chain.hold(kTip, Hold::kSurface);
  chain.move(kTip, Vec3(0.1, 0.2, 3.2));
  const std::uint64_t before = state_of(chain);
  const auto refused = [&](const std::function<void()>& action, const std::vector<std::string>& fragments) {
    expect_refusal(action, fragments);
    EXPECT_EQ(state_of(chain), before);
  };
  for (const int bad : {-1, 1, 2147483647}) {
    refused([&] { chain.hold({bad, true}, Hold::kPoint); }, {"part", std::to_string(bad)});
    refused([&] { chain.move({bad, true}, Vec3::Zero()); }, {"part", std::to_string(bad)});
    refused([&] { chain.force({bad, false}); }, {"part"});
    refused([&] { chain.moment({bad, false}); }, {"part"});
    refused([&] { chain.bone(bad); }, {"part"});
    refused([&] { chain.push({bad, 0, 0}, Vec3::Zero()); }, {"vertex.part", std::to_string(bad)});
  }
  for (const int bad : {-1, 3}) refused([&] { chain.hold(kTip, static_cast<Hold>(bad)); }, {"hold: what"});
  for (const double bad : {kNotANumber, kUnbounded, -kUnbounded, 1.01e6, -kLargest}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 v = Vec3::Zero();
      v[axis] = bad;
      refused([&] { chain.move(kTip, v); }, {"move: position", "permitted"});
      refused([&] { chain.move(kTip, v, Mat3::Identity()); }, {"move: position", "permitted"});
      refused([&] { chain.set_gravity(v); }, {"set_gravity: gravity", "permitted"});
      if (bad != 1.01e6) refused([&] { chain.push({0, 0, 0}, v); }, {"push: force", "permitted"});
    }
  }
  for (int entry = 0; entry < 9; ++entry) {
    for (const double bad : {kNotANumber, kUnbounded, 2.0}) {
      Mat3 turn = Mat3::Identity();
      turn(entry / 3, entry % 3) = bad;
      refused([&] { chain.move(kTip, Vec3(0, 0, 3), turn); }, {"move: turn", "permitted"});
    }
  }
  refused([&] { chain.move(kTip, Vec3(0, 0, 3), Mat3(-Mat3::Identity())); }, {"move: turn", "permitted"});
  for (const int bad : {-1, 3}) refused([&] { chain.push({0, bad, 0}, Vec3::Zero()); }, {"vertex.segment"});
  for (const int bad : {-1, 82}) {
    refused([&] { chain.push({0, 0, bad}, Vec3::Zero()); }, {"vertex.vertex", std::to_string(bad)});
    refused([&] { chain.point_of({0, 0, bad}); }, {"vertex.vertex"});
  }
}

TEST(AssemblyRefuses, ToMoveOrHoldWhatCannotBe) {
  Assembly chain(chain_of(2));
  expect_refusal([&] { chain.move(kTip, Vec3::Zero()); }, {"part 0 (tip)", "is not held", "hold()"});
  expect_refusal([&] { chain.move(kRoot, Vec3::Zero()); }, {"part 0 (root)", "is not held"});
  EXPECT_EQ(chain.force(kTip), Vec3::Zero().eval());
  Assembly figure(branched_figure());
  expect_refusal([&] { figure.hold({1, false}, Hold::kPoint); }, {"part 1", "joined to a patch"});
  EXPECT_EQ(figure.held({1, false}), Hold::kNothing);
}

}  // namespace
}  // namespace softpoint::elastic

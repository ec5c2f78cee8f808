// What a figure refuses, by name, and the readers of its text form.
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_stepper.h"
#include "support.h"
#include "support/refusal.h"

namespace softpoint::figure {
namespace {

Link rod(int parent = -1) {
  Link link;
  link.name = "rod";
  link.parent = parent;
  set_cylinder(link, 1.0, 0.05, 0.5);
  return link;
}

TEST(FigureModel, EveryFieldIsCheckedByName) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInf = std::numeric_limits<double>::infinity();
  const auto refuse = [](const char* field, auto change) {
    Link link = rod();
    change(link);
    expect_refusal([&] { FigureModel({link}); }, {"link 0 'rod'", field, "permitted"});
  };
  for (const double bad : {kNan, kInf, -kInf, 1e20}) {
    refuse("mass", [&](Link& l) { l.mass = bad; });
    refuse("origin", [&](Link& l) { l.origin.y() = bad; });
    refuse("center_of_mass", [&](Link& l) { l.center_of_mass.x() = bad; });
    refuse("axis", [&](Link& l) { l.axis.z() = bad; });
    refuse("orientation", [&](Link& l) { l.orientation(0, 1) = bad; });
    refuse("inertia", [&](Link& l) { l.inertia(2, 2) = bad; });
    refuse("armature", [&](Link& l) { l.armature = bad; });
    refuse("damping", [&](Link& l) { l.damping = bad; });
    refuse("friction", [&](Link& l) { l.friction = bad; });
    refuse("lower", [&](Link& l) { l.lower = bad; });
    refuse("upper", [&](Link& l) { l.upper = bad; });
  }
  refuse("mass", [](Link& l) { l.mass = -1; });
  refuse("mass", [](Link& l) { l.mass = 0, l.inertia.setZero(); });
  refuse("axis", [](Link& l) { l.axis.setZero(); });
  refuse("armature", [](Link& l) { l.armature = -1; });
  refuse("damping", [](Link& l) { l.damping = -1; });
  refuse("upper", [](Link& l) { l.lower = 1, l.upper = 0; });
  refuse("parent", [](Link& l) { l.parent = 0; });
  refuse("parent", [](Link& l) { l.parent = -2; });
  refuse("inertia", [](Link& l) { l.inertia(0, 1) = 1; });
  refuse("inertia", [](Link& l) { l.inertia = Vec3(1, 1, 3).asDiagonal(); });
  refuse("inertia", [](Link& l) { l.inertia = Vec3(-1, 1, 1).asDiagonal(); });
  refuse("inertia", [](Link& l) { l.mass = 0; });
  expect_refusal([] { FigureModel({}); }, {"links is empty"});
  Link child = rod(0);
  child.joint = JointKind::kFree;
  expect_refusal([&] { FigureModel({rod(), child}); }, {"link 1 'rod'", "joint is free", "permitted"});
}

TEST(FigureModel, StatesAreChecked) {
  Link free = rod(), ball = rod(0);
  free.joint = JointKind::kFree;
  ball.joint = JointKind::kBall;
  const FigureModel model({free, ball});
  const auto refuse = [&](auto change, const char* what) {
    FigureState state = rest_state(model);
    change(state);
    const FigureState before = state;
    expect_refusal([&] { check_state(model, state); }, {what, "permitted"});
    EXPECT_EQ(before.q.size(), state.q.size());
  };
  refuse([](FigureState& s) { s.q.pop_back(); }, "q has 10 numbers");
  refuse([](FigureState& s) { s.qd.push_back(0); }, "qd has 10 numbers");
  refuse([](FigureState& s) { s.q[1] = std::numeric_limits<double>::quiet_NaN(); }, "link 0 'rod' q");
  refuse([](FigureState& s) { s.qd[7] = 1e300; }, "link 1 'rod' qd");
  refuse([](FigureState& s) { s.q[3] = 0; }, "quaternion");
  FigureState state = rest_state(model);
  state.q[7] = 3;
  check_state(model, state);
  EXPECT_EQ(state.q[7], 1);
}

TEST(FigureModel, PlainTextIsReadBackAndBadLinesAreNamed) {
  const FigureModel model = read_amdl_file(data_file("mjhum27.amdl"));
  EXPECT_EQ(model.link_count(), 22);
  EXPECT_EQ(model.velocity_count(), 27);
  EXPECT_EQ(model.find("elbow_left"), 21);
  EXPECT_EQ(model.find("tail"), -1);
  EXPECT_NEAR(model.links()[4].lower, -0.5235987755982988, 1e-15);
  const auto refuse = [](const std::string& text, const char* what) {
    std::istringstream in(text);
    expect_refusal([&] { read_amdl(in, "figure"); }, {"figure", what});
  };
  const std::string good = "a -1 1 0 1 0 0 0 0 1 0 0 -0.5 0.1 0.1 0.01 0 0 0 -1 1\n";
  refuse("", "links is empty");
  refuse("# nothing\n\n", "links is empty");
  refuse("a -1 1 0 1\n", "line 1 link 'a': axis is no number");
  refuse("# x\na -1 7 0 1 0 0 0 0 1 0 0 -0.5 0.1 0.1 0.01 0 0 0 -1 1\n",
         "line 2 link 'a': type = 7; permitted");
  refuse("a -1 1 0 one 0\n", "axis is no number");
  refuse(good + "b 5 1 0 1 0 0 0 0 1 0 0 -0.5 0.1 0.1 0.01 0 0 0 -1 1\n", "link 1 'b' parent = 5; permitted");
  refuse(good.substr(0, good.size() - 1) + " 3\n", "'3' after the last number");
}

TEST(FigureStepper, AFallingBodyFalls) {
  Link body = rod();
  body.joint = JointKind::kFree;
  const FigureModel model({body});
  FigureStepper stepper(model, rest_state(model));
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(stepper.step(0.1));
  EXPECT_NEAR(stepper.state().q[2], -0.5 * 9.81, 1e-12);
  EXPECT_NEAR(stepper.time(), 1, 1e-12);
  expect_refusal([&] { stepper.step(0); }, {"dt = 0", "permitted"});
  expect_refusal([&] { stepper.step(2); }, {"dt = 2", "permitted"});
}

}  // namespace
}  // namespace softpoint::figure

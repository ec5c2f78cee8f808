// `softpoint figure`, run as a user runs it, against the trajectories that several engines agree on.
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "csv_table.h"
#include "play_fixture.h"
#include "softpoint/figure/urdf.h"

namespace softpoint::scene {
namespace {

using nlohmann::json;

// Not by `+`: g++ 12 takes that for an overlap.
std::string numbered(const char* name, int k) {
  std::string text(name);
  text += std::to_string(k);
  return text;
}

std::string reference(const std::string& name) { return std::string(SOFTPOINT_FIGURE_DATA) + "/" + name; }

std::string file_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

CsvTable expected(const std::string& name) { return {file_text(reference(name)), name}; }

class FigureCommand : public Play {
 protected:
  int figure(const std::string& arguments) const { return run("figure " + arguments); }
  CsvTable trace(const std::string& name = "trace.csv") const { return {text(name), name}; }
  void put(const std::string& name, const std::string& content) const {
    std::ofstream(in_folder(name)) << content;
  }
  // Exit code 1 and one line that holds all fragments.
  void refused(const std::string& arguments, const std::vector<std::string>& fragments) const {
    EXPECT_EQ(figure(arguments), 1) << arguments;
    const std::string message = text("stderr");
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 1) << message;
    for (const std::string& fragment : fragments) {
      EXPECT_NE(message.find(fragment), std::string::npos) << message << "\nlacks: " << fragment;
    }
  }
};

// Largest difference in the columns that both have, until a time; how many columns it were.
double difference(const CsvTable& a, const CsvTable& b, double until, const std::vector<std::string>& names) {
  EXPECT_EQ(a.rows(), b.rows());
  double worst = 0;
  for (const std::string& name : names) {
    const std::vector<double> x = a.column(name), y = b.column(name), t = b.column("t");
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
      if (t[i] <= until) worst = std::max(worst, std::abs(x[i] - y[i]));
    }
  }
  return worst;
}

TEST_F(FigureCommand, DoublePendulumR1) {
  put("start.json", R"({"q": [-1.5707963267948966, -0.5]})");
  ASSERT_EQ(figure(reference("pend2.amdl") +
                   " --state start.json --time 5 --step 0.0005208333333333333 --every 32 --integrator dopri5 "
                   "--trace trace.csv"),
            0)
      << text("stderr");
  const CsvTable wanted = expected("out_own_r1_double_pendulum.csv"), got = trace();
  EXPECT_EQ(got.columns(), wanted.columns());
  const double q = difference(got, wanted, 5, {"t", "q0", "q1"}),
               energy = difference(got, wanted, 5, {"energy"});
  std::printf("    r1 %.1e rad, energy %.1e J\n", q, energy);
  EXPECT_LE(q, 1e-8);
  EXPECT_LE(energy, 1e-8);
  for (const char* name : {"variational", "paper", "rk4"}) {  // the same by less exact ones
    ASSERT_EQ(figure(reference("pend2.amdl") +
                     " --state start.json --time 1 --step 0.0005208333333333333 --every 32 --trace other.csv"
                     " --integrator " +
                     name),
              0);
    const CsvTable other = trace("other.csv");
    double worst = 0;
    for (std::size_t i = 0; i < other.rows(); ++i)
      worst = std::max(worst, std::abs(other.at(i, 2) - wanted.at(i, 2)));
    std::printf("    %s %.1e\n", name, worst);
    EXPECT_LE(worst, 0.02);
    EXPECT_GT(worst, 1e-14);
  }
}

TEST_F(FigureCommand, HumanoidInFreeFlightR3) {
  const CsvTable wanted = expected("out_own_r3_humanoid_spin.csv");
  const auto cells = [&](std::initializer_list<const char*> names) {
    json list = json::array();
    for (const char* name : names) list.push_back(wanted.column(name)[0]);
    return list;
  };
  json state;
  state["base"] = {{"position", cells({"px", "py", "pz"})},
                   {"orientation", cells({"qw", "qx", "qy", "qz"})},
                   {"angular_velocity", cells({"wx", "wy", "wz"})},
                   {"velocity", cells({"vx", "vy", "vz"})}};
  for (int k = 0; k < 21; ++k) {
    state["q"].push_back(wanted.column(numbered("q", k))[0]);
    state["qd"].push_back(wanted.column(numbered("qd", k))[0]);
  }
  put("start.json", state.dump());
  ASSERT_EQ(figure(reference("mjhum27.amdl") +
                   " --state start.json --time 1 --step 0.0005208333333333333 --every 16 --integrator dopri5 "
                   "--dynamic all --trace trace.csv"),
            0)
      << text("stderr");
  const CsvTable got = trace();
  EXPECT_EQ(got.columns(), wanted.columns());
  std::vector<std::string> pose = {"qw", "qx", "qy", "qz", "px", "py", "pz"};
  for (int k = 0; k < 21; ++k) pose.push_back(numbered("q", k));
  const double half = difference(got, wanted, 0.5001, pose), whole = difference(got, wanted, 1, pose);
  const double rates = difference(got, wanted, 0.5001, {"wx", "vz", "qd0", "qd20"});
  std::printf("    r3 %.1e, first half %.1e, its rates %.1e\n", whole, half, rates);
  EXPECT_LE(whole, 1e-8);
  EXPECT_LE(half, 1e-10);
  EXPECT_LE(rates, 1e-8);
}

TEST_F(FigureCommand, ChainOfBallsR2) {
  ASSERT_EQ(figure(reference("chain4ball.amdl") + " --state " + reference("chain4ball_state.json") +
                   " --time 2 --step 0.0010416666666666667 --every 8 --integrator dopri5 --trace trace.csv"),
            0)
      << text("stderr");
  const CsvTable wanted = expected("out_simbody_r2_ball_chain.csv"), got = trace();
  ASSERT_EQ(got.rows(), wanted.rows());
  ASSERT_EQ(got.columns().size(), 1u + 16 + 12 + 1);
  double worst = 0, spin = 0;
  for (std::size_t row = 0; row < got.rows(); ++row) {
    // Down the chain: the trace has relative turns and rates, the reference those in the world.
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    Eigen::Vector3d joint = Eigen::Vector3d::Zero(), rate = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      const auto q = [&](std::size_t k) { return got.at(row, 1 + 4 * i + k); };
      const auto qd = [&](std::size_t k) { return got.at(row, 17 + 3 * i + k); };
      const auto want = [&](std::size_t k) { return wanted.at(row, 1 + 10 * i + k); };
      turn = turn * Eigen::Quaterniond(q(0), q(1), q(2), q(3));
      rate += turn * Eigen::Vector3d(qd(0), qd(1), qd(2));
      const Eigen::Vector3d center = joint + turn * Eigen::Vector3d(0, 0, -0.2);
      joint += turn * Eigen::Vector3d(0, 0, -0.4);
      worst = std::max(worst, (center - Eigen::Vector3d(want(0), want(1), want(2))).norm());
      spin = std::max(spin, (rate - Eigen::Vector3d(want(7), want(8), want(9))).norm());
    }
  }
  std::printf("    r2 %.1e m, %.1e rad/s\n", worst, spin);
  EXPECT_LE(worst, 1e-9);
  EXPECT_LE(spin, 1e-8);
}

TEST_F(FigureCommand, DoublePendulumAgainstStopsR6) {
  put("start.json", R"({"q": [-1.5707963267948966, -0.5], "qd": [0, 0]})");
  ASSERT_EQ(figure(reference("pend2_limits.amdl") +
                   " --state start.json --time 3 --step 0.0010416666666666667 --every 16 --integrator dopri5 "
                   "--limits exact --trace trace.csv"),
            0)
      << text("stderr");
  const double q = difference(trace(), expected("out_own_r6_double_pendulum_limit.csv"), 3, {"q0", "q1"});
  std::printf("    r6 %.1e rad\n", q);
  EXPECT_LE(q, 1e-8);
  EXPECT_NE(text("stdout").find("5 impacts, 5 releases"), std::string::npos) << text("stdout");
}

// The elbow follows a file; what the shoulder then does is checked against its own equation of motion.
TEST_F(FigureCommand, PrescribedJointsPushTheOthers) {
  std::string table = "# elbow\nt, p1\n";
  for (int i = 0; i <= 400; ++i) {
    const double t = i / 200.0;
    table += std::to_string(t) + "," + json(0.8 * std::sin(4 * t)).dump() + "\n";
  }
  put("elbow.csv", table);
  ASSERT_EQ(
      figure(reference("pend2.amdl") + " --prescribe elbow.csv --time 2 --step 0.005 --trace trace.csv"), 0)
      << text("stderr");
  const CsvTable got = trace();
  ASSERT_EQ(got.rows(), 401u);
  double file = 0;
  for (std::size_t i = 0; i < got.rows(); ++i) {
    file = std::max(file, std::abs(got.at(i, 2) - 0.8 * std::sin(4 * got.at(i, 0))));
    file = std::max(file, std::abs(got.at(i, 4) - 3.2 * std::cos(4 * got.at(i, 0))) / 100);
  }
  EXPECT_LE(file, 1e-7);
  // Planar rods of 1 kg and 1 m about y: moment of momentum about the pivot changes by that of gravity.
  const double i0 = 1.0 / 12;
  const auto turn = [&](double a, double b, double va, double vb) {  // angles from hanging, absolute rates
    const double c = std::cos(a - b);
    return (i0 + 0.25 + 1) * va + (i0 + 0.25) * vb + 0.5 * c * (va + vb);
  };
  double worst = 0, impulse = 0, before = 0;
  for (std::size_t k = 0; k < got.rows(); ++k) {
    const double a = got.at(k, 1), b = a + got.at(k, 2), va = got.at(k, 3), vb = va + got.at(k, 4);
    const double moment = -9.81 * (1.5 * std::sin(a) + 0.5 * std::sin(b));
    if (k > 0) impulse += 0.005 * 0.5 * (moment + before);
    before = moment;
    const double start = turn(0, 0, got.at(0, 3), got.at(0, 3) + got.at(0, 4));
    worst = std::max(worst, std::abs(turn(a, b, va, vb) - start - impulse));
  }
  std::printf("    moment of momentum off by %.1e of %.1e\n", worst, 9.81);
  EXPECT_LE(worst, 1e-3);  // of the trapezoid sum
  // The same by hand-picked joints, and in its own words.
  ASSERT_EQ(figure(reference("pend2.amdl") +
                   " --prescribe elbow.csv --dynamic p0 --time 2 --step 0.005 --trace other.csv"),
            0);
  EXPECT_EQ(text("other.csv"), text("trace.csv"));
}

TEST_F(FigureCommand, HeldJointsStandAndShortStepsEndOnTime) {
  put("start.json", R"({"q": [0.3, -0.5], "qd": [1, 2]})");
  ASSERT_EQ(figure(reference("pend2.amdl") + " --state start.json --dynamic p1 --time 1 --step 0.3 --every 2 "
                                             "--gravity -1,0,0 --trace trace.csv"),
            0)
      << text("stderr");
  EXPECT_NE(text("stderr").find("joint 'p0' is held"), std::string::npos);
  const CsvTable got = trace();
  EXPECT_EQ(got.column("t"), (std::vector<double>{0, 0.6, 1}));
  EXPECT_EQ(got.column("q0"), (std::vector<double>(3, 0.3)));
  EXPECT_EQ(got.column("qd0"), (std::vector<double>(3, 0.0)));
  ASSERT_EQ(figure(reference("pend2.amdl") +
                   " --gravity 0,0,0 --dynamic none --time 0 --step 0.1 --trace none.csv"),
            0);
  EXPECT_EQ(trace("none.csv").rows(), 1u);
}

// A skeleton as model, its motion written as one, which is a model again.
TEST_F(FigureCommand, ReadsAndWritesSkeletons) {
  put("stick.bvh",
      "HIERARCHY ROOT hip { OFFSET 0 0 0 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
      "Yrotation "
      "JOINT knee { OFFSET 0 0 -0.5 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0 0 -0.4 } } "
      "} "
      "MOTION Frames: 0 Frame Time: 0.1");
  put("start.json", R"({"base": {"position": [0, 0, 2], "velocity": [1, 0, 0]}, "qd": [[0, 3, 0]]})");
  ASSERT_EQ(
      figure("stick.bvh --state start.json --time 0.5 --step 0.01 --every 5 --trace trace.csv --bvh out.bvh"),
      0)
      << text("stderr");
  EXPECT_EQ(trace().rows(), 11u);
  EXPECT_NE(text("out.bvh").find("Frames: 11\nFrame Time: 0.05\n"), std::string::npos);
  ASSERT_EQ(figure("out.bvh --time 0.1 --step 0.1 --trace again.csv"), 0) << text("stderr");
  EXPECT_EQ(trace("again.csv").columns(), trace().columns());
}

TEST_F(FigureCommand, RobotsStandOrFallAsTheyAreTold) {
  put("box.urdf",
      "<robot name='box'><link name='body'><inertial><mass value='2'/><inertia ixx='1' ixy='0' ixz='0' "
      "iyy='1' "
      "iyz='0' izz='1'/></inertial></link><link name='arm'><inertial><origin xyz='0 0 -0.5'/><mass "
      "value='1'/>"
      "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link><joint name='shoulder' "
      "type='continuous'><parent link='body'/><child link='arm'/><axis xyz='0 1 0'/></joint></robot>");
  const std::string run_it = "box.urdf --time 1 --step 0.01 --trace trace.csv ";
  if (!softpoint::figure::has_urdf()) {
    refused(run_it, {"without liburdfdom"});
    return;
  }
  ASSERT_EQ(figure(run_it), 0) << text("stderr");  // it has a mass: it falls
  EXPECT_NEAR(trace().column("pz").back(), -0.5 * 9.81, 1e-9);
  ASSERT_EQ(figure(run_it + "--base fixed --dynamic shoulder"), 0) << text("stderr");
  EXPECT_EQ(trace().columns().size(), 4u);
  refused(run_it + "--dynamic arm", {"--dynamic 'arm'", "shoulder"});
  refused(reference("pend2.amdl") + " --base free --time 1 --step 0.1 --trace trace.csv", {"--base free"});
}

TEST_F(FigureCommand, RefusesInOneLine) {
  const std::string run_it = reference("pend2.amdl") + " --time 1 --step 0.01 --trace trace.csv ";
  refused("nowhere.amdl --time 1 --step 0.01 --trace trace.csv", {"nowhere.amdl cannot be read"});
  refused(run_it + "--dynamic p0,knee", {"--dynamic 'knee'", "permitted are p0, p1"});
  refused(run_it + "--limits exact --integrator paper", {"limits = exact", "permitted"});
  refused(run_it + "--limits paper", {"limits = paper with the integrator rk4"});
  const auto state = [&](const std::string& content, const std::vector<std::string>& fragments) {
    put("start.json", content);
    refused(run_it + "--state start.json", fragments);
  };
  state("{", {"start.json:1:1", "syntax error"});
  state("[]", {"start.json", "permitted is an object"});
  state(R"({"speed": 1})", {"/speed", "permitted are base, q, qd"});
  state(R"({"q": [1]})", {"/q = [1]", "2 entries"});
  state(R"({"q": [1, [1, 0, 0, 0]]})", {"/q/1 (joint 'p1')", "a number"});
  state(R"({"qd": [1, 1e300]})", {"/qd/1", "permitted"});
  state(R"({"base": {"position": [0, 0, 0]}})", {"/base", "stands on the world"});
  const auto table = [&](const std::string& content, const std::vector<std::string>& fragments) {
    put("motion.csv", content);
    refused(run_it + "--prescribe motion.csv", fragments);
  };
  table("", {"motion.csv", "first column"});
  table("time,p0\n0,0\n1,1\n", {"first column is 'time'"});
  table("t\n0\n1\n", {"permitted is a joint"});
  table("t,p0,p0\n0,0,0\n1,1,1\n", {"line 1", "'p0'"});
  table("t,knee\n0,0\n1,1\n", {"'knee'", "p0, p1"});
  table("t,p0\n0,0\n1,x\n", {"line 3 column 'p0' = 'x'", "finite number"});
  table("t,p0\n0,0\n1\n", {"line 3 has 1 cells; permitted are 2"});
  table("t,p0\n0,0\n0,1\n", {"motion.csv", "spline time 1", "increase"});
  table("t,p0\n0,0\n0.5,1\n", {"times from 0 to 0.5", "cover 0 to 1"});
  put("motion.csv", "t,p0\n0,0\n1,1\n");
  refused(run_it + "--prescribe motion.csv --dynamic all", {"'p0' is in the file of --prescribe"});
  refused(run_it + "--prescribe motion.csv --dynamic p0,p1", {"'p0' is in the file of --prescribe"});
  EXPECT_EQ(figure(run_it + "--integrator euler"), 2);
  EXPECT_EQ(figure(reference("pend2.amdl") + " --time 1 --trace trace.csv"), 2);
  EXPECT_EQ(figure(run_it + "--gravity 1,2"), 2);
}

}  // namespace
}  // namespace softpoint::scene

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "document_kinds.h"
#include "sibling.h"
#include "softpoint/core/obj.h"
#include "softpoint/core/shapes.h"
#include "static_problem_file.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

namespace softpoint::scene {
namespace {

using nlohmann::json;

struct Outcome {
  int exit_code;
  std::string out, err;
};

class Solve : public ::testing::Test {
 protected:
  std::filesystem::path in_folder(const std::string& name) const { return folder_.path() / name; }

  std::string text(const std::string& name) const {
    std::ifstream in(in_folder(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  Outcome program(const std::string& arguments) const {
    const std::string command = std::string(SOFTPOINT_PROGRAM) + " " + arguments + " >" +
                                in_folder("stdout").string() + " 2>" + in_folder("stderr").string();
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text("stdout"), text("stderr")};
  }

  Outcome solve(const json& problem) const {
    std::ofstream(in_folder("problem.json")) << problem;
    return program("solve " + in_folder("problem.json").string() + " --out " +
                   in_folder("result.json").string());
  }

  json result() const { return json::parse(text("result.json")); }

  TriangleMesh mesh_file(const TriangleMesh& mesh) const {
    write_obj(in_folder("part.obj"), mesh);
    return mesh;
  }

  static json problem() {
    return {{"mesh", "part.obj"}, {"material", {{"young", 1e5}, {"poisson", 0.3}, {"density", 1000}}}};
  }

  TemporaryFolder folder_;
};

Vec3 vec3(const json& row) { return {row[0].get<double>(), row[1].get<double>(), row[2].get<double>()}; }

// Hooke's law: sigma = lambda tr(e) 1 + 2 mu e.
Mat3 stress(const Mat3& strain, double young, double poisson) {
  const double mu = young / (2.0 * (1.0 + poisson));
  const double lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
  return lambda * strain.trace() * Mat3::Identity() + 2.0 * mu * strain;
}

TEST_F(Solve, HeldAffineStateIsExact) {
  const TriangleMesh mesh = mesh_file(prism(6, 2, 1, 0.5, 1.0));
  Mat3 gradient;
  gradient << 1e-3, 2e-3, 0, -1e-3, 3e-3, 5e-4, 0, 1e-3, -2e-3;
  json setup = problem();
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 u = gradient * mesh.vertices[v];
    setup["displacement"].push_back({{"vertices", {v}}, {"value", {u.x(), u.y(), u.z()}}});
  }
  const Outcome run = solve(setup);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const json answer = result();
  const Mat3 strain = 0.5 * (gradient + gradient.transpose());
  const Mat3 sigma = stress(strain, 1e5, 0.3);
  std::vector<Vec3> expected(mesh.vertices.size(), Vec3::Zero());
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    for (const int v : mesh.triangles[t]) {
      expected[v] += sigma * triangle_normal(mesh, t) * triangle_area(mesh, t) / 3.0;
    }
  }
  const double scale = sigma.norm() * surface_area(mesh);
  ASSERT_EQ(answer["nodal_force"].size(), mesh.vertices.size());
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_LT((vec3(answer["nodal_force"][v]) - expected[v]).norm(), 1e-10 * scale);
    EXPECT_LT((vec3(answer["displacement"][v]) - gradient * mesh.vertices[v]).norm(), 1e-15);
  }
  ASSERT_EQ(answer["traction"].size(), mesh.triangles.size());
  const double energy = 0.5 * (sigma * strain).trace() * signed_volume(mesh);
  EXPECT_NEAR(answer["energy"].get<double>(), energy, 1e-10 * energy);
}

TEST_F(Solve, BarUnderTensionHangsFromRollers) {
  const TriangleMesh mesh = mesh_file(box_grid(2, 2, 2, Vec3(1.0, 1.0, 1.0)));
  json base = json::array(), top = json::array();
  int centre = -1, side = -1;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.vertices[v].z() == -0.5) {
      base.push_back(v);
      centre = mesh.vertices[v].head<2>().isZero() ? v : centre;
      side = mesh.vertices[v].head<2>().isApprox(Vec3(0.5, 0.0, 0.0).head<2>()) ? v : side;
    }
  }
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    if (triangle_normal(mesh, t).z() > 0.9) {
      top.push_back(t);
    }
  }
  json setup = problem();
  setup["material"]["young"] = "0.1 MPa";
  setup["displacement"] = {{{"vertices", base}, {"value", {nullptr, nullptr, "0 mm"}}},
                           {{"vertices", {centre}}, {"value", {0, 0, nullptr}}},
                           {{"vertices", {side}}, {"value", {nullptr, 0, nullptr}}}};
  setup["traction"] = {{{"faces", top}, {"value", {0, 0, "1 kPa"}}}};
  const Outcome run = solve(setup);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json answer = result();
  const double strain = 1e3 / 1e5;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3& x = mesh.vertices[v];
    const Vec3 expected(-0.3 * strain * x.x(), -0.3 * strain * x.y(), strain * (x.z() + 0.5));
    EXPECT_LT((vec3(answer["displacement"][v]) - expected).norm(), 1e-10 * strain) << v;
  }
  EXPECT_NEAR(answer["energy"].get<double>(), 0.5 * 1e3 * strain, 1e-9);
  EXPECT_EQ(answer["free_rigid_motions"].get<int>(), 0);
  EXPECT_GT(answer["seconds"]["total"].get<double>(), 0.0);
}

TEST_F(Solve, BarHangingFromABalancedTractionStretchesUnderItsWeight) {
  const TriangleMesh mesh = mesh_file(prism(16, 4, 1, 0.5, 1.0));
  json setup = problem();
  setup["gravity"] = {0, 0, -1};  // 1000 N/m3
  json top = json::array();
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    if (triangle_normal(mesh, t).z() > 0.9) {
      top.push_back(t);
    }
  }
  setup["traction"] = {{{"faces", top}, {"value", {0, 0, 1000}}}};
  const Outcome run = solve(setup);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json answer = result();
  EXPECT_EQ(answer["free_rigid_motions"].get<int>(), 6);
  const auto height_change = [&](int v) {
    return answer["displacement"][v][2].get<double>() -
           answer["displacement"][mesh.vertex_count() - 1][2].get<double>();
  };
  EXPECT_NEAR(height_change(0), -0.005, 1e-9);     // bottom centre against top centre
  EXPECT_NEAR(height_change(1), -0.004625, 1e-9);  // bottom rim
}

TEST_F(Solve, RefusesAMeshTooLargeForMemoryBeforehand) {
  mesh_file(sphere(1.0, 6));
  const Outcome run = solve(problem());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("40962 vertices"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("needs "), std::string::npos) << run.err;
}

TEST_F(Solve, ResultReadsBackAsTheSameDoubles) {
  elastic::StaticResult given;
  given.displacement = {{1.0 / 3.0, -0.0, 5e-324}, {1e300, 0.1, 2.0}};
  given.nodal_force = {{M_PI, 1e-17, -7.0}, {0, 0, 0}};
  given.traction = {{123456789.123456789, 0, 1}};
  given.energy = std::nextafter(1.0, 2.0);
  const json back = json::parse(static_result_json(given));
  for (std::size_t v = 0; v < 2; ++v) {
    EXPECT_EQ(vec3(back["displacement"][v]), given.displacement[v]);
    EXPECT_EQ(vec3(back["nodal_force"][v]), given.nodal_force[v]);
  }
  EXPECT_EQ(vec3(back["traction"][0]), given.traction[0]);
  EXPECT_EQ(back["energy"].get<double>(), given.energy);
  given.traction[0].x() = std::nan("");
  EXPECT_THROW(static_result_json(given), Error);
}

TEST_F(Solve, RefusesInOneLineWithExitCodeOne) {
  mesh_file(box_grid(1, 1, 1, Vec3(1.0, 1.0, 1.0)));
  struct Case {
    const char* what;
    void (*spoil)(json&);
    std::vector<std::string> fragments;
  };
  const std::vector<Case> cases = {
      {"no mesh", [](json& p) { p.erase("mesh"); }, {"\"mesh\" is missing"}},
      {"no such mesh",
       [](json& p) { p["mesh"] = "none.obj"; },
       {"problem.json: /mesh = \"none.obj\"", "No such file"}},
      {"misspelt key",
       [](json& p) { p["material"]["yung"] = 1; },
       {"/material/yung", "did you mean \"young\"?"}},
      {"wrong unit",
       [](json& p) { p["material"]["young"] = "1 kg"; },
       {"/material/young = \"1 kg\"", "pressure"}},
      {"poisson", [](json& p) { p["material"]["poisson"] = 0.5; }, {"/material/poisson = 0.5", "0.49"}},
      {"negative",
       [](json& p) { p["material"]["young"] = -5; },
       {"/material/young = -5", "1e-06 to 1e+15 Pa"}},
      {"vertex",
       [](json& p) {
         p["displacement"] = {{{"vertices", {8}}, {"value", {0, 0, 0}}}};
       },
       {"/displacement/0/vertices/0 = 8", "0 to 7"}},
      {"face",
       [](json& p) {
         p["traction"] = {{{"faces", {12}}, {"value", {0, 0, 0}}}};
       },
       {"/traction/0/faces/0 = 12", "0 to 11"}},
      {"null load",
       [](json& p) {
         p["traction"] = {{{"faces", {1}}, {"value", {0, nullptr, 0}}}};
       },
       {"/traction/0/value/1 = null"}},
      {"no density",
       [](json& p) {
         p["material"].erase("density");
         p["gravity"] = {0, 0, -9.81};
       },
       {"/gravity", "\"density\" is missing"}},
      {"unbalanced",
       [](json& p) {
         p["gravity"] = {0, 0, -9.81};
       },
       {"problem.json", "balance"}},
      {"two values",
       [](json& p) {
         p["displacement"] = {{{"vertices", {1}}, {"value", {0, 0, 0}}},
                              {{"vertices", {1}}, {"value", {1, 0, 0}}}};
       },
       {"problem.json", "1"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    json setup = problem();
    c.spoil(setup);
    const Outcome run = solve(setup);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(run.err.rfind("softpoint: ", 0), 0u) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    for (const std::string& fragment : c.fragments) {
      EXPECT_NE(run.err.find(fragment), std::string::npos) << run.err << "lacks " << fragment;
    }
    EXPECT_FALSE(std::filesystem::exists(in_folder("result.json")));
  }
}

TEST_F(Solve, RefusesAMeshThatBoundsNoSolid) {
  TriangleMesh mesh = box_grid(1, 1, 1, Vec3(1.0, 1.0, 1.0));
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  mesh_file(mesh);
  const Outcome run = solve(problem());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("part.obj: triangle 3"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("flip triangle 3"), std::string::npos) << run.err;
}

TEST_F(Solve, RefusesAnOutputThatCannotBeWrittenBeforeWorking) {
  mesh_file(box_grid(1, 1, 1, Vec3(1.0, 1.0, 1.0)));
  std::ofstream(in_folder("problem.json")) << problem();
  for (const std::string out : {"no/such/result.json", ".", "/dev/null"}) {
    const Outcome run =
        program("solve " + in_folder("problem.json").string() + " --out " + (in_folder("") / out).string());
    EXPECT_EQ(run.exit_code, 1) << out;
    EXPECT_NE(run.err.find("cannot be written"), std::string::npos) << run.err;
  }
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(Solve, LeavesNothingButTheResult) {
  mesh_file(box_grid(1, 1, 1, Vec3(1.0, 1.0, 1.0)));
  std::ofstream(in_folder("result.json")) << "old";
  ASSERT_EQ(solve(problem()).exit_code, 0);
  EXPECT_TRUE(result().contains("displacement"));
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    names.insert(entry.path().filename().string());
  }
  EXPECT_EQ(names, (std::set<std::string>{"part.obj", "problem.json", "result.json", "stdout", "stderr"}));
}

TEST_F(Solve, UsageErrorsHaveExitCodeTwo) {
  for (const char* arguments : {"", "dance", "solve", "solve a.json", "solve a.json --out b.json c.json",
                                "solve a.json --out", "schema dance", "--frames"}) {
    const Outcome run = program(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_NE(run.err, "") << arguments;
  }
  EXPECT_EQ(program("--help").exit_code, 0);
  EXPECT_EQ(program("solve --help").exit_code, 0);
  EXPECT_EQ(program("--version").out.rfind("softpoint 0.1.0", 0), 0u);
}

TEST_F(Solve, SchemaNamesEveryKey) {
  for (const char* arguments : {"schema", "schema solve", "schema solve --markdown"}) {
    const Outcome run = program(arguments);
    EXPECT_EQ(run.exit_code, 0);
    for (const char* key :
         {"/mesh", "/material/young", "/material/poisson", "/material/density", "/displacement/*/vertices",
          "/displacement/*/value", "/traction/*/faces", "/traction/*/value", "/gravity"}) {
      EXPECT_NE(run.out.find(key), std::string::npos) << arguments << " lacks " << key;
    }
  }
}

TEST(Sibling, StandsBesideThisProgram) {
  const auto self = std::filesystem::read_symlink("/proc/self/exe");
  EXPECT_EQ(sibling_path(Precision::kSingle), self.parent_path() / "softpoint");
  EXPECT_EQ(sibling_path(Precision::kDouble), self.parent_path() / "softpoint-float64");
}

TEST(Sibling, TheOtherPrecisionTakesOverOrIsMissed) {
  const Precision other = kBuiltPrecision == Precision::kSingle ? Precision::kDouble : Precision::kSingle;
  const int expected = std::filesystem::exists(sibling_path(other)) ? 0 : 7;
  const auto run = [&] {
    try {
      exec_sibling(other, {"softpoint", "--version"});
    } catch (const Error&) {
      std::_Exit(7);
    }
    std::_Exit(8);
  };
  EXPECT_EXIT(run(), ::testing::ExitedWithCode(expected), "");
}

TEST(Sibling, TheOwnPrecisionNeedsNone) { EXPECT_NO_THROW(exec_sibling(kBuiltPrecision, {"softpoint"})); }

}  // namespace
}  // namespace softpoint::scene

#include "softpoint/core/obj.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <fstream>
#include <random>

#include "softpoint/core/shapes.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"
#include "support/tier.h"

namespace softpoint {
namespace {

class Obj : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) {
    const auto path = folder_.path() / "part.obj";
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  TriangleMesh read(const std::string& text) { return read_obj(file(text)); }

  TemporaryFolder folder_;
};

const char* const kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(Obj, GivesBackTheDoublesWritten) {
  const Mat3 stretch = Vec3(1.0 / 3.0, 1e-7, 1e9).asDiagonal();
  const TriangleMesh mesh = transformed(prism(16, 4, 1, 0.5, 1.0), stretch, Vec3(0.1, -0.2, 0.3));
  write_obj(folder_.path() / "a.obj", mesh);
  const TriangleMesh back = read_obj(folder_.path() / "a.obj");
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.triangles, mesh.triangles);
}

TEST_F(Obj, CutsPolygonsIntoFans) {
  const TriangleMesh mesh = read(std::string(kSquare) + "f 1 2 3 4\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST_F(Obj, SkipsWhatIsNoGeometry) {
  const TriangleMesh mesh = read(
      "# made by hand\r\nmtllib x.mtl\nt 1000000000/1000000000/1 a\no part\n  v 0 0 0 # first\r\nv 1 0 0 "
      "1.0\n\n"
      "v 1 1 0 0.5 0.5 0.5\nvn 0 0 1\nvt 0 0\ng side\nusemtl red\ns 1\nf 1/1/1 2/1/1 3//1\nf 1 2\t-1");
  EXPECT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}}));
}

TEST_F(Obj, CountsNegativeIndicesFromTheLine) {
  const TriangleMesh mesh = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -4 -2 -1\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST_F(Obj, RefusesNamingFileAndLine) {
  const std::string square = kSquare;
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"", {"part.obj: holds no vertices"}},
      {"# nothing\n", {"part.obj: holds no vertices"}},
      {square, {"part.obj: holds no faces"}},
      {"v 0 0 0\nv 1 nan 0\n", {"part.obj:2: vertex 1", "y coordinate \"nan\""}},
      {"v inf 0 0\n", {"part.obj:1: vertex 0", "x coordinate \"inf\""}},
      {"v 0 0 1e999\n", {"part.obj:1:", "z coordinate \"1e999\""}},
      {"v 0 0\n", {"part.obj:1:", "z coordinate \"\""}},
      {"v 0 0 0,5\n", {"part.obj:1:", "\"0,5\""}},
      {"v\n", {"part.obj:1: v without numbers"}},
      {square + "f 1 2 5\n", {"part.obj:5: face 0", "\"5\"", "1 to 4"}},
      {square + "f 1 2 0\n", {"part.obj:5:", "\"0\""}},
      {square + "f 1 2 -5\n", {"part.obj:5:", "\"-5\""}},
      {square + "f 1 2 4294967297\n", {"part.obj:5:", "4294967297"}},
      {square + "f 1 2 3\nf 1 x 3\n", {"part.obj:6: face 1", "\"x\""}},
      {square + "f 1 2\n", {"part.obj:5:", "2 corners"}},
      {square + "f\n", {"part.obj:5: f without numbers"}},
      {square + "f 1 2 \\\n3\n", {"part.obj:5:", "join"}},
      {"v 0 0 0\rv 1 0 0\r", {"part.obj:1:", "line feed"}},
      {std::string("v 0 0 0\n\0\0", 10), {"part.obj:2:", "no text file"}},
  };
  for (const auto& [text, fragments] : cases) {
    SCOPED_TRACE(text);
    expect_refusal([&] { read(text); }, fragments);
  }
}

TEST_F(Obj, RefusesMissingFilesAndFolders) {
  expect_refusal([&] { read_obj(folder_.path() / "none.obj"); }, {"none.obj", "No such file"});
  expect_refusal([&] { read_obj(folder_.path()); }, {"folder"});
  expect_refusal([&] { read_obj("/dev/zero"); }, {"/dev/zero:1: a line of more than 1048576 characters"});
  expect_refusal([&] { write_obj(folder_.path() / "no" / "a.obj", sphere(1.0, 0)); }, {"a.obj", "no folder"});
}

TEST_F(Obj, DoesNotDependOnTheLocale) {
  // Any locale with a decimal comma will do; without one installed the test still checks the C locale.
  for (const char* locale : {"de_DE.UTF-8", "fr_FR.UTF-8", "C"}) {
    std::setlocale(LC_ALL, locale);
    const TriangleMesh mesh = transformed(sphere(1.0, 0), 0.37 * Mat3::Identity(), Vec3::Zero());
    write_obj(folder_.path() / "a.obj", mesh);
    EXPECT_EQ(read_obj(folder_.path() / "a.obj").vertices, mesh.vertices);
  }
  std::setlocale(LC_ALL, "C");
}

TEST_F(Obj, RandomDamageNeverCrashes) {
  std::mt19937 random(11);
  write_obj(folder_.path() / "good.obj", prism(4, 1, 1, 0.5, 1.0));
  std::ifstream in(folder_.path() / "good.obj", std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  const int rounds = by_tier(1500, 300, 100);
  int accepted = 0;
  for (int round = 0; round < rounds; ++round) {
    std::string text = good.substr(0, round % 2 ? good.size() : random() % good.size());
    for (int k = 0; k < 4 && !text.empty(); ++k) {
      text[random() % text.size()] = static_cast<char>(random());
    }
    try {
      for (const Vec3& x : read(text).vertices) {
        ASSERT_TRUE(x.allFinite());
      }
      ++accepted;
    } catch (const Error& error) {
      ASSERT_NE(std::string(error.what()).find("part.obj"), std::string::npos);
    }
  }
  EXPECT_LT(accepted, rounds);
}

}  // namespace
}  // namespace softpoint

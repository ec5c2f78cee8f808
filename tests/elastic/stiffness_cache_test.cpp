// A cache may only ever save time.
#include "softpoint/elastic/stiffness_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "elastic_support.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

namespace softpoint::elastic {
namespace {

namespace fs = std::filesystem;

TriangleMesh small_solid() { return box_grid(1, 1, 1, Vec3(1, 1, 1)); }

class StiffnessCache : public testing::Test {
 protected:
  CacheSettings in(const fs::path& folder) const {
    CacheSettings settings;
    settings.folder = folder;
    return settings;
  }
  std::shared_ptr<const BoundaryStiffness> get(const TriangleMesh& mesh) const {
    return load_or_assemble_stiffness(mesh, 0.3, {}, cache_);
  }
  fs::path file(const TriangleMesh& mesh) const { return cache_path(mesh, 0.3, {}, cache_); }
  int file_count() const {
    int count = 0;
    for (auto it = fs::directory_iterator(cache_.folder); it != fs::directory_iterator(); ++it) ++count;
    return count;
  }
  // The file is damaged by `damage`; the next call must notice, rebuild it, and the one after must hit.
  template <class Damage>
  void expect_rebuilt(const Damage& damage) {
    const TriangleMesh mesh = small_solid();
    const auto good = get(mesh);
    damage(file(mesh));
    const CacheCounters before = cache_counters();
    const auto rebuilt = get(mesh);
    const CacheCounters after = cache_counters();
    EXPECT_FALSE(rebuilt->from_cache);
    EXPECT_EQ(rebuilt->unit_stiffness, good->unit_stiffness);
    EXPECT_EQ(after.rejected, before.rejected + 1);
    EXPECT_EQ(after.misses, before.misses + 1);
    EXPECT_EQ(after.written, before.written + 1);
    EXPECT_TRUE(get(mesh)->from_cache);
    EXPECT_EQ(file_count(), 1);
  }

  TemporaryFolder folder_;
  CacheSettings cache_ = in(folder_.path() / "made" / "on demand");
};

std::string content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void replace_content(const fs::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
}

TEST_F(StiffnessCache, SecondCallReadsTheSameBits) {
  const TriangleMesh mesh = standard_part();
  const CacheCounters before = cache_counters();
  const auto made = get(mesh), read = get(mesh);
  const CacheCounters after = cache_counters();
  EXPECT_FALSE(made->from_cache);
  EXPECT_TRUE(read->from_cache);
  EXPECT_EQ(read->unit_stiffness, made->unit_stiffness);
  EXPECT_EQ(read->gravity_columns, made->gravity_columns);
  EXPECT_TRUE(read->unit_traction.empty());
  EXPECT_EQ(read->mesh.triangles, mesh.triangles);
  EXPECT_EQ(read->poisson, 0.3);
  EXPECT_EQ(read->quadrature.far_points, made->quadrature.far_points);
  EXPECT_EQ(after.hits, before.hits + 1);
  EXPECT_EQ(after.misses, before.misses + 1);
  EXPECT_EQ(after.written, before.written + 1);
}

TEST_F(StiffnessCache, Reads82VerticesWithinTenMilliseconds) {
  const TriangleMesh mesh = standard_part();
  get(mesh);
  double best = 1e9;
  for (int i = 0; i < 5; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const auto model = get(mesh);
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    ASSERT_TRUE(model->from_cache);
  }
  std::printf("82 vertices from the cache: %.2f ms, %ju bytes\n", 1e3 * best, fs::file_size(file(mesh)));
  EXPECT_LE(best, 0.01);
}

TEST_F(StiffnessCache, KeyCoversAllThatMatters) {
  const TriangleMesh mesh = small_solid();
  TriangleMesh moved = mesh;
  moved.vertices[3].y() = std::nextafter(moved.vertices[3].y(), 10.0);
  TriangleMesh renumbered = mesh;
  std::swap(renumbered.triangles[0], renumbered.triangles[1]);
  StiffnessSettings traction, rough, baseline;
  traction.keep_traction = true;
  rough.quadrature = Quadrature::coarse();
  baseline.max_instruction_set = InstructionSet::kBaseline;
  std::vector<std::string> paths = {
      cache_path(mesh, 0.3, {}, cache_),       cache_path(moved, 0.3, {}, cache_),
      cache_path(renumbered, 0.3, {}, cache_), cache_path(mesh, 0.31, {}, cache_),
      cache_path(mesh, 0.3, traction, cache_), cache_path(mesh, 0.3, rough, cache_)};
  if (best_instruction_set() != InstructionSet::kBaseline)
    paths.push_back(cache_path(mesh, 0.3, baseline, cache_));
  std::sort(paths.begin(), paths.end());
  EXPECT_EQ(std::adjacent_find(paths.begin(), paths.end()), paths.end());
  // Zeros resolve before they are hashed.
  StiffnessSettings spelled_out;
  spelled_out.quadrature = {6, 0, 6, 1.5};
  EXPECT_EQ(cache_path(mesh, 0.3, spelled_out, cache_), cache_path(mesh, 0.3, {}, cache_));
}

TEST_F(StiffnessCache, KeepsTheTractionOperator) {
  StiffnessSettings settings;
  settings.keep_traction = true;
  const auto made = load_or_assemble_stiffness(small_solid(), 0.3, settings, cache_);
  const auto read = load_or_assemble_stiffness(small_solid(), 0.3, settings, cache_);
  EXPECT_TRUE(read->from_cache);
  EXPECT_FALSE(read->unit_traction.empty());
  EXPECT_EQ(read->unit_traction, made->unit_traction);
}

TEST_F(StiffnessCache, TruncatedFileIsRebuilt) {
  expect_rebuilt([](const fs::path& path) { fs::resize_file(path, fs::file_size(path) - 1); });
  expect_rebuilt([](const fs::path& path) { fs::resize_file(path, fs::file_size(path) / 2); });
  expect_rebuilt([](const fs::path& path) { fs::resize_file(path, 0); });
}

TEST_F(StiffnessCache, ForeignFileIsRebuilt) {
  expect_rebuilt([](const fs::path& path) { replace_content(path, "not ours"); });
  expect_rebuilt([](const fs::path& path) { replace_content(path, std::string(fs::file_size(path), 'x')); });
  expect_rebuilt([](const fs::path& path) { replace_content(path, content_of(path) + "tail"); });
}

TEST_F(StiffnessCache, FileOfAnotherMatrixIsRebuilt) {
  TriangleMesh other = small_solid();
  other.vertices[0].x() -= 0.125;
  get(other);
  const std::string content = content_of(file(other));
  fs::remove(file(other));
  expect_rebuilt([&](const fs::path& path) { replace_content(path, content); });
}

TEST_F(StiffnessCache, EveryFlippedBitIsNoticed) {
  const TriangleMesh mesh = small_solid();
  get(mesh);
  const std::string good = content_of(file(mesh));
  Noise noise;
  for (std::size_t i = 0; i < 200; ++i) {
    // The whole header, then anywhere.
    const std::size_t at = i < 60 ? i : static_cast<std::size_t>((noise() + 1.0) / 2.0 * (good.size() - 1.0));
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ (1 << (i % 8)));
    replace_content(file(mesh), bad);
    const CacheCounters before = cache_counters();
    EXPECT_FALSE(get(mesh)->from_cache) << "byte " << at;
    EXPECT_EQ(cache_counters().rejected, before.rejected + 1) << "byte " << at;
  }
  EXPECT_EQ(content_of(file(mesh)), good);
}

TEST_F(StiffnessCache, FolderInPlaceOfTheFileIsHarmless) {
  const TriangleMesh mesh = small_solid();
  fs::create_directories(file(mesh) / "occupied");
  EXPECT_FALSE(get(mesh)->from_cache);
  EXPECT_FALSE(get(mesh)->from_cache);
  EXPECT_EQ(file_count(), 1);  // no unfinished file stays
}

TEST_F(StiffnessCache, PipeInPlaceOfTheFileDoesNotBlock) {
  const TriangleMesh mesh = small_solid();
  fs::create_directories(cache_.folder);
  ASSERT_EQ(::mkfifo(file(mesh).c_str(), 0600), 0);
  EXPECT_FALSE(get(mesh)->from_cache);
}

// A folder that nobody can make, not even root: its parent is a file.
TEST_F(StiffnessCache, ImpossibleFolderIsHarmless) {
  replace_content(folder_.path() / "file", "");
  cache_ = in(folder_.path() / "file" / "cache");
  const CacheCounters before = cache_counters();
  EXPECT_FALSE(get(small_solid())->from_cache);
  EXPECT_FALSE(get(small_solid())->from_cache);
  EXPECT_EQ(cache_counters().written, before.written);
  EXPECT_EQ(cache_counters().misses, before.misses + 2);
}

// Root may write anywhere, so a child gives its rights away first.
TEST_F(StiffnessCache, ReadOnlyFolderStillServesReaders) {
  const TriangleMesh mesh = small_solid();
  get(mesh);
  fs::permissions(folder_.path(), fs::perms(0755));
  fs::permissions(fs::path(cache_.folder).parent_path(), fs::perms(0755));
  fs::permissions(file(mesh), fs::perms(0444));
  fs::permissions(cache_.folder, fs::perms(0555));
  const pid_t child = ::fork();
  if (child == 0) {
    if (::getuid() == 0 && ::setuid(65534) != 0) ::_exit(2);
    const bool hit = get(mesh)->from_cache;
    const std::uint64_t written = cache_counters().written;
    TriangleMesh other = mesh;
    other.vertices[0].x() -= 0.25;
    const bool made =
        !get(other)->from_cache && !get(other)->from_cache && cache_counters().written == written;
    ::_exit(hit && made ? 0 : 1);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  fs::permissions(cache_.folder, fs::perms(0755));
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(StiffnessCache, OldestFilesMakeRoom) {
  std::vector<TriangleMesh> meshes(4, small_solid());
  for (int i = 0; i < 4; ++i) meshes[i].vertices[0].x() -= 0.1 * i;
  get(meshes[0]);
  cache_.capacity = 2.5 * static_cast<double>(fs::file_size(file(meshes[0])));
  const CacheCounters before = cache_counters();
  for (int i = 1; i < 4; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    get(meshes[0]);  // used again: now the youngest
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    get(meshes[i]);
  }
  EXPECT_EQ(cache_counters().evicted, before.evicted + 2);
  EXPECT_TRUE(fs::exists(file(meshes[0])));
  EXPECT_FALSE(fs::exists(file(meshes[1])));
  EXPECT_FALSE(fs::exists(file(meshes[2])));
  EXPECT_TRUE(fs::exists(file(meshes[3])));
}

TEST_F(StiffnessCache, MatrixBeyondTheCapacityIsNotKept) {
  cache_.capacity = 1000.0;
  EXPECT_FALSE(get(small_solid())->from_cache);
  EXPECT_FALSE(fs::exists(file(small_solid())));
  expect_refusal(
      [&] {
        cache_.capacity = -1;
        get(small_solid());
      },
      {"cache.capacity = -1"});
}

TEST_F(StiffnessCache, LeavesOtherPeoplesFilesAlone) {
  fs::create_directories(cache_.folder);
  const fs::path other = fs::path(cache_.folder) / "letters.txt";
  replace_content(other, std::string(100000, 'a'));
  cache_.capacity = 50000.0;
  get(small_solid());
  EXPECT_TRUE(fs::exists(other));
}

TEST_F(StiffnessCache, WritersAtOnceDoNotDisturbEachOther) {
  const TriangleMesh mesh = small_solid();
  const auto expected = assemble_stiffness(mesh, 0.3);
  std::vector<pid_t> children;
  for (int i = 0; i < 6; ++i) {
    const pid_t child = ::fork();
    if (child == 0) {
      bool good = true;
      for (int round = 0; round < 30; ++round) {
        good = good && get(mesh)->unit_stiffness == expected->unit_stiffness;
        if (round % 3 == i % 3) fs::remove(file(mesh));
      }
      ::_exit(good ? 0 : 1);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = -1;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  EXPECT_LE(file_count(), 1);
  get(mesh);
  EXPECT_TRUE(get(mesh)->from_cache);
}

TEST_F(StiffnessCache, IsOffWithoutAFolder) {
  cache_.folder.clear();
  EXPECT_FALSE(get(small_solid())->from_cache);
  EXPECT_EQ(cache_path(small_solid(), 0.3, {}, cache_), "");
}

TEST_F(StiffnessCache, RefusesWhatAssemblyRefuses) {
  TriangleMesh open = small_solid();
  open.triangles.pop_back();
  expect_refusal([&] { get(open); }, {"mesh"});
  expect_refusal([&] { load_or_assemble_stiffness(small_solid(), 0.5, {}, cache_); }, {"material.poisson"});
  EXPECT_THROW(load_or_assemble_stiffness(TriangleMesh{}, 0.3, {}, cache_), softpoint::Error);
}

// Restores a variable of the environment.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    const char* before = std::getenv(name);
    was_set_ = before != nullptr;
    before_ = was_set_ ? before : "";
    value == nullptr ? ::unsetenv(name) : ::setenv(name, value, 1);
  }
  ~Variable() { was_set_ ? ::setenv(name_, before_.c_str(), 1) : ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  bool was_set_;
  std::string before_;
};

TEST(CacheFolder, FollowsTheEnvironment) {
  const Variable own("SOFTPOINT_CACHE_DIR", nullptr), xdg("XDG_CACHE_HOME", nullptr),
      home("HOME", "/home/someone");
  EXPECT_EQ(CacheSettings::default_folder(), "/home/someone/.cache/softpoint");
  {
    const Variable set("XDG_CACHE_HOME", "/var/caches");
    EXPECT_EQ(CacheSettings::default_folder(), "/var/caches/softpoint");
    const Variable mine("SOFTPOINT_CACHE_DIR", "/elsewhere");
    EXPECT_EQ(CacheSettings{}.folder, "/elsewhere");
    const Variable off("SOFTPOINT_CACHE_DIR", "");
    EXPECT_EQ(CacheSettings::default_folder(), "");
  }
  const Variable relative("XDG_CACHE_HOME", "caches");
  EXPECT_EQ(CacheSettings::default_folder(), "/home/someone/.cache/softpoint");
  const Variable nobody("HOME", nullptr);
  EXPECT_EQ(CacheSettings::default_folder(), "");
}

}  // namespace
}  // namespace softpoint::elastic

#include "softpoint/core/atomic_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "support/refusal.h"
#include "support/temporary_folder.h"

namespace softpoint {
namespace {

class AtomicFile : public ::testing::Test {
 protected:
  static std::string text(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::ptrdiff_t files() const {
    return std::distance(std::filesystem::directory_iterator(folder_.path()), {});
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "a.txt";
};

TEST_F(AtomicFile, ReplacesTheOldFileAndLeavesNothingElse) {
  write_atomically(path_, "one");
  EXPECT_EQ(text(path_), "one");
  write_atomically(path_, std::string_view("t\0o", 3));
  EXPECT_EQ(text(path_), std::string("t\0o", 3));
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFile, WritesThroughALink) {
  std::filesystem::create_directory(folder_.path() / "inner");
  write_atomically(folder_.path() / "inner" / "b.txt", "old");
  std::filesystem::create_symlink("inner/b.txt", path_);
  write_atomically(path_, "new");
  EXPECT_TRUE(std::filesystem::is_symlink(path_));
  EXPECT_EQ(text(folder_.path() / "inner" / "b.txt"), "new");
}

TEST_F(AtomicFile, RefusesWhatIsNoRegularFile) {
  expect_refusal([&] { write_atomically(folder_.path(), "x"); }, {"no regular file"});
  expect_refusal([&] { write_atomically("/dev/null", "x"); }, {"/dev/null", "no regular file"});
  expect_refusal([&] { write_atomically(folder_.path() / "no" / "a.txt", "x"); }, {"no folder"});
  expect_refusal([&] { check_writable(path_ / "a.txt"); }, {"no folder"});
  EXPECT_NO_THROW(check_writable(path_));
  EXPECT_EQ(files(), 0);
}

TEST_F(AtomicFile, AReaderNeverSeesAPart) {
  const std::string a(100000, 'a'), b(100000, 'b');
  write_atomically(path_, a);
  std::thread first([&] {
    for (int k = 0; k < 50; ++k) {
      write_atomically(path_, a);
    }
  });
  std::thread second([&] {
    for (int k = 0; k < 50; ++k) {
      write_atomically(path_, b);
    }
  });
  for (int k = 0; k < 200; ++k) {
    const std::string seen = text(path_);
    EXPECT_TRUE(seen == a || seen == b) << seen.size();
  }
  first.join();
  second.join();
  EXPECT_EQ(files(), 1);
}

}  // namespace
}  // namespace softpoint

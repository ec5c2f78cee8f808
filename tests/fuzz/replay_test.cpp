// The kept inputs of a fuzzer, through its entry function: what once broke a reader never does so again.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>

#include "fuzz/fuzz_support.h"

namespace softpoint {
namespace {

void run(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

TEST(FuzzReplay, OfTheKeptCorpus) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SOFTPOINT_CORPUS_FOLDER)) {
    SCOPED_TRACE(entry.path().string());
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string input{std::istreambuf_iterator<char>(in), {}};
    EXPECT_NO_THROW(run(input));
    // Cut off anywhere.
    for (std::size_t length = 0; length < input.size(); length += 1 + input.size() / 50) {
      EXPECT_NO_THROW(run(input.substr(0, length))) << "the first " << length << " bytes";
    }
    // A few bytes changed; the same ones each time.
    std::mt19937 random(7);
    for (int round = 0; round < 50 && !input.empty(); ++round) {
      std::string damaged = input;
      for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
      EXPECT_NO_THROW(run(damaged)) << "round " << round;
    }
    ++count;
  }
  EXPECT_GE(count, 5) << "the corpus of " SOFTPOINT_FUZZ_NAME " is gone";
}

}  // namespace
}  // namespace softpoint

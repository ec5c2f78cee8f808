#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>

#include "softpoint/picture/image.h"
#include "softpoint/picture/png.h"

namespace softpoint {

// Has the environment variable SOFTPOINT_TEST_REFRESH_GOLDEN a value?
inline bool golden_refresh_asked() {
  const char* value = std::getenv("SOFTPOINT_TEST_REFRESH_GOLDEN");
  return value && *value;
}

// Compares pictures with stored ones. In the folder of the stored ones there are <name>.png and hashes.txt
// with lines "<name> <hash> <driver>": the drivers that draw exactly this picture. A driver that is not
// listed (another Mesa version, processor or graphics hardware) rounds otherwise and gets `least_psnr`.
struct GoldenImages {
  std::filesystem::path stored;
  std::filesystem::path output;  // for what was drawn instead; made when it is needed
  double least_psnr = 35;        // dB
  // Nothing is compared: the picture is stored anew, and the test fails, so that nobody takes it for passed.
  bool refresh = golden_refresh_asked();

  ::testing::AssertionResult matches(const std::string& name, const picture::Image& image,
                                     const std::string& driver) const {
    if (refresh) return store(name, image, driver);
    const auto file = stored / (name + ".png");
    if (!std::filesystem::exists(file)) {
      return mismatch(name, image, nullptr) << "there is no " << file.string();
    }
    const picture::Image golden = picture::read_png(file.string());
    if (golden.width != image.width || golden.height != image.height) {
      return mismatch(name, image, nullptr) << "it is " << image.width << "x" << image.height
                                            << ", stored is " << golden.width << "x" << golden.height;
    }
    const std::string wanted = hash_of(name, driver);
    const double ratio = picture::psnr(image, golden);
    if (!wanted.empty() && wanted != text(picture::hash(image))) {
      return mismatch(name, image, &golden) << "this driver drew it otherwise once (" << driver
                                            << "); peak signal-to-noise ratio " << ratio << " dB";
    }
    if (wanted.empty() && !(ratio >= least_psnr)) {
      return mismatch(name, image, &golden)
             << "peak signal-to-noise ratio " << ratio << " dB, permitted is from " << least_psnr << " ("
             << driver << ")";
    }
    return ::testing::AssertionSuccess();
  }

 private:
  static std::string text(std::uint64_t hash) {
    std::ostringstream out;
    out << std::hex << std::setw(16) << std::setfill('0') << hash;
    return out.str();
  }

  std::filesystem::path hashes() const { return stored / "hashes.txt"; }

  // "" for a driver not listed.
  std::string hash_of(const std::string& name, const std::string& driver) const {
    std::ifstream in(hashes());
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line);
      std::string of, hash, by;
      words >> of >> hash >> std::ws;
      std::getline(words, by);
      if (of == name && by == driver) return hash;
    }
    return "";
  }

  ::testing::AssertionResult store(const std::string& name, const picture::Image& image,
                                   const std::string& driver) const {
    std::filesystem::create_directories(stored);
    std::ostringstream lines;  // of the other pictures
    {
      std::ifstream in(hashes());
      for (std::string line; std::getline(in, line);) {
        if (line.rfind(name + " ", 0) != 0) lines << line << "\n";
      }
    }
    // Hardware need not repeat its own bits.
    if (driver.rfind("llvmpipe", 0) == 0)
      lines << name << " " << text(picture::hash(image)) << " " << driver << "\n";
    std::ofstream(hashes()) << lines.str();
    const auto file = stored / (name + ".png");
    picture::write_png(file.string(), image);
    return ::testing::AssertionFailure() << "stored anew: " << file.string()
                                         << "; look at it, then test without SOFTPOINT_TEST_REFRESH_GOLDEN";
  }

  // Leaves the picture, and how it differs: black where it does not, brighter by 8 for each step of a
  // channel.
  ::testing::AssertionResult mismatch(const std::string& name, const picture::Image& image,
                                      const picture::Image* golden) const {
    std::filesystem::create_directories(output);
    const auto actual = output / (name + ".actual.png"), difference = output / (name + ".difference.png");
    picture::write_png(actual.string(), image);
    ::testing::AssertionResult result = ::testing::AssertionFailure();
    result << "the picture " << name << " is not the stored one\n  drawn:  " << actual.string();
    if (golden) {
      picture::Image shown = image;
      for (std::size_t i = 0; i < shown.rgba.size(); ++i) {
        const int step = std::abs(int{image.rgba[i]} - int{golden->rgba[i]});
        shown.rgba[i] = i % 4 == 3 ? std::uint8_t{255} : static_cast<std::uint8_t>(std::min(8 * step, 255));
      }
      picture::write_png(difference.string(), shown);
      result << "\n  differs: " << difference.string();
    }
    return result << "\n  stored: " << (stored / (name + ".png")).string()
                  << "\n  (SOFTPOINT_TEST_REFRESH_GOLDEN=1 stores what is drawn now)\n";
  }
};

}  // namespace softpoint

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "player.h"
#include "softpoint/figure/bvh.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// The motion of a scene's figures for animation programs, a BVH file a figure.
class FigureMotionFiles {
 public:
  // `folder` is made; records the start. Throws Error if a file cannot be written there, or the scene has no
  // figure.
  FigureMotionFiles(const Player& player, const std::filesystem::path& folder);
  void record();  // a frame
  // All that was recorded; the names of the files.
  std::vector<std::string> write() const;

 private:
  std::filesystem::path file(std::size_t figure) const;

  const Player& player_;
  std::filesystem::path folder_;
  std::vector<figure::BvhRecorder> clips_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

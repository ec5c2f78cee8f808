#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

class Player;

struct PictureOptions {
  std::filesystem::path folder;  // made if it is not there
  int width = 0, height = 0;     // pixels
  bool pictures = true;
  bool video = false;
};

// What is drawn of a scene in play.
class PictureOutput {
 public:
  PictureOutput() = default;
  PictureOutput(const PictureOutput&) = delete;
  PictureOutput& operator=(const PictureOutput&) = delete;
  virtual ~PictureOutput() = default;

  // Once for the state at the start and after each step.
  virtual void take() = 0;
  // Completes sheet and film.
  virtual void finish() = 0;
  virtual const std::filesystem::path& folder() const = 0;
  // File names in the folder, in order.
  virtual const std::vector<std::string>& files() const = 0;
};

// Making one takes an OpenGL context. Null in a program built without the picture plugin. Throws Error for a
// folder that cannot be written, where no context can be had, and where no video can be made.
std::unique_ptr<PictureOutput> make_picture_output(Player& player, const PictureOptions& options);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "player.h"
#include "softpoint/picture/contact_sheet.h"
#include "softpoint/picture/renderer.h"
#include "softpoint/picture/video.h"
#include "softpoint/picture/world_painter.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

struct PictureOptions {
  std::filesystem::path folder;  // made if it is not there
  int width = 0, height = 0;     // pixels
  bool pictures = true;
  bool video = false;
};

// Draws a scene in play: pictures at the frames it asks for, a contact sheet of them, and a film. Making
// one takes an OpenGL context.
class PictureTaker {
 public:
  // Throws Error for a folder that cannot be written, or where no video can be made.
  PictureTaker(Player& player, const PictureOptions& options);

  // Once for the state at the start and after each step.
  void take();
  // Completes sheet and film.
  void finish();

  const std::filesystem::path& folder() const { return options_.folder; }
  // File names in the folder, in order.
  const std::vector<std::string>& files() const { return files_; }

 private:
  bool picture_due() const;
  int film_frames_due() const;
  void dress();
  void draw();
  void draw_overlays();
  void draw_force(const Vec3& point, const Vec3& vector, picture::Color color);
  picture::Camera camera() const;
  std::string caption() const;

  Player& player_;
  PictureOptions options_;
  std::set<int> frames_;  // of PictureSpec::times
  std::optional<Vec3> followed_from_;
  picture::Renderer renderer_;
  picture::WorldPainter painter_;
  picture::ContactSheet sheet_;
  std::unique_ptr<picture::VideoWriter> film_;
  double film_fps_ = 0;
  bool wireframe_ = false;
  picture::Image image_;
  std::vector<std::string> files_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

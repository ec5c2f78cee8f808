#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "picture_output.h"
#include "picture_pieces.h"
#include "player.h"
#include "sheet_curves.h"
#include "softpoint/picture/contact_sheet.h"
#include "softpoint/picture/renderer.h"
#include "softpoint/picture/video.h"
#include "softpoint/picture/world_painter.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Draws a scene in play: pictures at the frames it asks for, a contact sheet of them, curves over time where
// there is cloth, and a film.
class PictureTaker final : public PictureOutput {
 public:
  // Throws Error for a folder that cannot be written, or where no video can be made.
  PictureTaker(Player& player, const PictureOptions& options);

  void take() override;
  void finish() override;
  const std::filesystem::path& folder() const override { return options_.folder; }
  const std::vector<std::string>& files() const override { return files_; }

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
  PiecePainter pieces_;
  SheetCurves curves_;  // curves.png
  picture::ContactSheet sheet_;
  std::unique_ptr<picture::VideoWriter> film_;
  double film_fps_ = 0;
  bool wireframe_ = false;
  picture::Image image_;
  std::vector<std::string> files_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

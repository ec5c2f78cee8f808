#pragma once

#include <string>
#include <vector>

#include "softpoint/picture/image.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Layout of a contact sheet.
struct ContactSheetSettings {
  int columns = 4;       // 1 to 64
  int cell_width = 320;  // pixels of each small picture, 16 to 4096; its height follows the first frame
  int gap = 6;           // pixels between and around the cells, 0 to 100
  Color paper{0.97F, 0.97F, 0.96F};  // behind the cells
};

// Frames side by side, row by row, each shrunk by a box filter and with its caption below. Keeps the small
// pictures only.
class SOFTPOINT_API ContactSheet {
 public:
  // Throws Error for settings out of range.
  explicit ContactSheet(const ContactSheetSettings& settings = {});

  // Throws Error for a frame narrower than a cell, or of another size than the first.
  void add(const Image& frame, const std::string& caption);
  // Frames added.
  int count() const { return static_cast<int>(cells_.size()); }
  // Throws Error when nothing was added.
  Image image() const;

 private:
  struct Cell {
    Image picture;
    std::string caption;
  };
  ContactSheetSettings settings_;
  int frame_width_ = 0, frame_height_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

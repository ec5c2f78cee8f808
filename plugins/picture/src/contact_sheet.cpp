#include "softpoint/picture/contact_sheet.h"

#include <algorithm>
#include <cmath>

#include "softpoint/core/error.h"
#include "softpoint/picture/text.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

TextStyle caption_style() {
  TextStyle style;
  style.backing.a = 0;
  return style;
}

}  // namespace

ContactSheet::ContactSheet(const ContactSheetSettings& settings) : settings_(settings) {
  check_range("contact sheet columns", settings.columns, 1, 64);
  check_range("contact sheet cell_width", settings.cell_width, 16, 4096);
  check_range("contact sheet gap", settings.gap, 0, 100);
  check(settings.paper, "contact sheet paper");
}

void ContactSheet::add(const Image& frame, const std::string& caption) {
  check_range("contact sheet frame width", frame.width, settings_.cell_width, 1 << 16);
  if (cells_.empty()) {
    frame_width_ = frame.width;
    frame_height_ = frame.height;
  }
  if (frame.width != frame_width_ || frame.height != frame_height_) {
    throw Error("contact sheet frame = " + std::to_string(frame.width) + "x" + std::to_string(frame.height) +
                ": permitted is the size of the first, " + std::to_string(frame_width_) + "x" +
                std::to_string(frame_height_));
  }
  const double height = static_cast<double>(settings_.cell_width) * frame.height / frame.width;
  cells_.push_back(
      {shrink(frame, settings_.cell_width, std::max(1, static_cast<int>(std::lround(height)))), caption});
}

Image ContactSheet::image() const {
  if (cells_.empty()) throw Error("contact sheet frames = 0: permitted is at least one");
  const int columns = std::min(settings_.columns, count());
  const int rows = (count() + columns - 1) / columns;
  const int caption_height = measure_text("x", caption_style()).height;
  const int step_x = settings_.cell_width + settings_.gap;
  const int step_y = cells_.front().picture.height + caption_height + settings_.gap;
  Image sheet(columns * step_x + settings_.gap, rows * step_y + settings_.gap, settings_.paper);
  for (int i = 0; i < count(); ++i) {
    const Cell& cell = cells_[static_cast<std::size_t>(i)];
    const int left = settings_.gap + (i % columns) * step_x, top = settings_.gap + (i / columns) * step_y;
    for (int y = 0; y < cell.picture.height; ++y) {
      std::copy_n(cell.picture.pixel(0, y), 4 * static_cast<std::size_t>(cell.picture.width),
                  sheet.pixel(left, top + y));
    }
    draw_text(sheet, left, top + cell.picture.height, cell.caption, caption_style());
  }
  return sheet;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

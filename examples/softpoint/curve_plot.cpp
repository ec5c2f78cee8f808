#include "curve_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "softpoint/picture/material.h"
#include "softpoint/picture/text.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr int kFine = 3;  // drawn that many times larger, then shrunk
constexpr int kWidth = 900, kHeight = 190;
constexpr int kLeft = 86, kRight = 16, kTop = 26, kBottom = 14, kFoot = 22;  // pixels
constexpr picture::Color kPaper{1.0F, 1.0F, 1.0F}, kGrid{0.88F, 0.88F, 0.88F}, kFrame{0.45F, 0.45F, 0.45F};

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void take(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  // From 0 on where that is near, never empty.
  void settle() {
    if (low > high) low = high = 0.0;
    if (low > 0.0 && low < 0.5 * high) low = 0.0;
    if (high < 0.0 && high > 0.5 * low) high = 0.0;
    const double size = std::max(std::abs(low), std::abs(high));
    if (high - low < std::max(1e-12, 1e-6 * size)) {  // all the same
      low -= std::max(1e-12, 0.5 * size);
      high += std::max(1e-12, 0.5 * size);
    }
    const double margin = 0.04 * (high - low);
    if (low != 0.0) low -= margin;
    high += margin;
  }
};

class Panel {
 public:
  Panel(picture::Image& image, int top, Range times, Range values)
      : image_(image), top_(top), times_(times), values_(values) {}

  double x(double time) const {
    return kLeft + (time - times_.low) / (times_.high - times_.low) * (kWidth - kLeft - kRight);
  }
  double y(double value) const {
    return top_ + kTop + (values_.high - value) / (values_.high - values_.low) * (kHeight - kTop - kBottom);
  }

  // A round stroke, in pixels of the finished picture.
  void stroke(double x0, double y0, double x1, double y1, double width, picture::Color color) {
    const double radius = 0.5 * width * kFine;
    const int steps = 1 + static_cast<int>(kFine * std::hypot(x1 - x0, y1 - y0));
    for (int i = 0; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps;
      dot(kFine * (x0 + s * (x1 - x0)), kFine * (y0 + s * (y1 - y0)), radius, color);
    }
  }

 private:
  void dot(double cx, double cy, double radius, picture::Color color) {
    const auto byte = [](float c) { return static_cast<std::uint8_t>(std::lround(255.0F * c)); };
    const int reach = static_cast<int>(std::ceil(radius));
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const int px = static_cast<int>(cx) + i, py = static_cast<int>(cy) + j;
        const double dx = px + 0.5 - cx, dy = py + 0.5 - cy;
        if (dx * dx + dy * dy > radius * radius) continue;
        if (px < 0 || py < 0 || px >= image_.width || py >= image_.height) continue;
        std::uint8_t* pixel = image_.pixel(px, py);
        pixel[0] = byte(color.r);
        pixel[1] = byte(color.g);
        pixel[2] = byte(color.b);
      }
    }
  }

  picture::Image& image_;
  int top_;
  Range times_, values_;
};

picture::TextStyle plain(picture::Color color = {0.13F, 0.15F, 0.18F}) {
  picture::TextStyle style;
  style.color = color;
  style.scale = 0.75;
  style.backing.a = 0.0F;
  return style;
}

std::string tick_text(double value, double spacing) {
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(spacing) - 1e-9)), 0, 9);
  const std::string text = fmt::format("{:.{}f}", value, digits);
  return text.size() < 10 ? text : fmt::format("{:.3g}", value);
}

// Lowers every curve to what a pixel can show: the least and the largest value of each.
void draw_curve(Panel& panel, const std::vector<double>& times, const Curve& curve, picture::Color color) {
  bool pen_down = false;
  double x0 = 0, y0 = 0;
  for (std::size_t i = 0; i < times.size() && i < curve.values.size(); ++i) {
    if (!std::isfinite(curve.values[i])) {
      pen_down = false;
      continue;
    }
    const double x1 = panel.x(times[i]), y1 = panel.y(curve.values[i]);
    if (pen_down) panel.stroke(x0, y0, x1, y1, 1.6, color);
    x0 = x1;
    y0 = y1;
    pen_down = true;
  }
}

}  // namespace

std::vector<double> round_ticks(double low, double high) {
  const double power = std::pow(10.0, std::floor(std::log10((high - low) / 3)));
  double spacing = power;
  for (const double factor : {2.0, 5.0}) {
    if ((high - low) / (factor * power) >= 3) spacing = factor * power;
  }
  std::vector<double> ticks;
  for (double k = std::ceil(low / spacing - 1e-9); k * spacing <= high + 1e-9 * spacing; k += 1.0) {
    ticks.push_back(k * spacing + 0.0);  // no negative zero
  }
  return ticks;
}

picture::Image draw_curves(const std::vector<double>& times, const std::vector<CurvePanel>& panels) {
  const int height = static_cast<int>(panels.size()) * kHeight + kFoot;
  picture::Image large(kFine * kWidth, kFine * height, kPaper);
  Range time_range;
  for (const double time : times) time_range.take(time);
  if (!(time_range.high > time_range.low)) time_range = {0.0, 1.0};
  const std::vector<double> time_ticks = round_ticks(time_range.low, time_range.high);

  struct Label {
    double x, y;
    std::string text;
    picture::Color color;
    bool to_the_left;
  };
  std::vector<Label> labels;
  for (std::size_t k = 0; k < panels.size(); ++k) {
    const int top = static_cast<int>(k) * kHeight;
    Range values;
    for (const Curve& curve : panels[k].curves) {
      for (const double value : curve.values) values.take(value);
    }
    values.settle();
    Panel panel(large, top, time_range, values);
    const double left = kLeft, right = kWidth - kRight, upper = top + kTop, lower = top + kHeight - kBottom;
    for (const double t : time_ticks) panel.stroke(panel.x(t), upper, panel.x(t), lower, 1, kGrid);
    const std::vector<double> ticks = round_ticks(values.low, values.high);
    const double spacing = ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
    for (const double v : ticks) {
      panel.stroke(left, panel.y(v), right, panel.y(v), 1, kGrid);
      labels.push_back({left - 4, panel.y(v) - 8, tick_text(v, spacing), kFrame, true});
    }
    for (const double x : {left, right}) panel.stroke(x, upper, x, lower, 1, kFrame);
    for (const double y : {upper, lower}) panel.stroke(left, y, right, y, 1, kFrame);
    labels.push_back({left, upper - 20, panels[k].title, plain().color, false});
    double at = left + picture::measure_text(panels[k].title, plain()).width + 14;
    for (std::size_t c = 0; c < panels[k].curves.size(); ++c) {
      const picture::Color color = picture::palette_color(static_cast<int>(c));
      draw_curve(panel, times, panels[k].curves[c], color);
      if (panels[k].curves[c].name.empty()) continue;
      labels.push_back({at, upper - 20, panels[k].curves[c].name, color, false});
      at += picture::measure_text(panels[k].curves[c].name, plain()).width + 10;
    }
  }
  picture::Image image = picture::shrink(large, kWidth, height);
  for (const Label& label : labels) {
    const int width = label.to_the_left ? picture::measure_text(label.text, plain()).width : 0;
    picture::draw_text(image, static_cast<int>(label.x) - width, static_cast<int>(label.y), label.text,
                       plain(label.color));
  }
  const double spacing = time_ticks.size() > 1 ? time_ticks[1] - time_ticks[0] : 1.0;
  const int foot = static_cast<int>(panels.size()) * kHeight - kBottom + 4;
  for (const double t : time_ticks) {
    const std::string text = tick_text(t, spacing) + " s";
    const double x =
        kLeft + (t - time_range.low) / (time_range.high - time_range.low) * (kWidth - kLeft - kRight);
    const int width = picture::measure_text(text, plain()).width;
    picture::draw_text(image, std::clamp(static_cast<int>(x) - width / 2, 0, kWidth - width), foot, text,
                       plain());
  }
  return image;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

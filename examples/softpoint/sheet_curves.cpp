#include "sheet_curves.h"

#include <limits>

#include "metrics_sheet.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

enum { kVolumePanel, kGaugePanel, kBubblesPanel, kForcePanel, kStretchPanel, kHeightPanel, kPanels };

}  // namespace

SheetCurves::SheetCurves(const Player& player) : player_(player) {
  for (std::size_t k = 0; k < player.deformable_count(); ++k) {
    if (player.sheet(k) != nullptr) sheets_.push_back(k);
  }
  panels_.resize(kPanels);
  panels_[kVolumePanel].title = "volume of closed bubbles, cm3";
  panels_[kGaugePanel].title = "pressure of the largest over the atmosphere, Pa";
  panels_[kBubblesPanel].title = "bubbles";
  panels_[kForcePanel].title = "vertical force of hands, N";
  panels_[kStretchPanel].title = "stretch of warp and weft, %";
  panels_[kHeightPanel].title = "height of the highest point, mm";
  for (const std::size_t k : sheets_) {
    const std::string& name = player.scene().deformables[k].name;
    const std::string of = sheets_.size() > 1 ? name : "";
    for (const int panel : {kVolumePanel, kGaugePanel, kBubblesPanel, kHeightPanel}) {
      panels_[static_cast<std::size_t>(panel)].curves.push_back({of, {}});
    }
    panels_[kStretchPanel].curves.push_back({of + (of.empty() ? "largest" : " largest"), {}});
    panels_[kStretchPanel].curves.push_back({of + (of.empty() ? "99th percentile" : " 99th percentile"), {}});
  }
  for (const std::string& handle : player.scene().handles)
    panels_[kForcePanel].curves.push_back({handle, {}});
}

void SheetCurves::record() {
  times_.push_back(player_.time());
  for (std::size_t i = 0; i < sheets_.size(); ++i) {
    const SheetState state = player_.sheet(sheets_[i])->measure();
    const bool known = player_.frame() > 0;  // air is found in the first step
    const double gap = std::numeric_limits<double>::quiet_NaN();
    panels_[kVolumePanel].curves[i].values.push_back(known ? 1e6 * state.volume : gap);
    panels_[kGaugePanel].curves[i].values.push_back(known ? state.gauge : gap);
    panels_[kBubblesPanel].curves[i].values.push_back(known ? state.bubbles : gap);
    panels_[kHeightPanel].curves[i].values.push_back(1e3 *
                                                     heights_of(player_.deformable(sheets_[i])).highest);
    panels_[kStretchPanel].curves[2 * i].values.push_back(100 * state.stretch);
    panels_[kStretchPanel].curves[2 * i + 1].values.push_back(100 * state.stretch_99);
  }
  for (std::size_t h = 0; h < player_.handles().count(); ++h) {
    panels_[kForcePanel].curves[h].values.push_back(player_.handles().force(h).y());
  }
}

picture::Image SheetCurves::image() const {
  std::vector<CurvePanel> panels;
  for (const CurvePanel& panel : panels_) {
    if (!panel.curves.empty()) panels.push_back(panel);
  }
  return draw_curves(times_, panels);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

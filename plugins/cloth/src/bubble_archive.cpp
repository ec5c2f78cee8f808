// What a snapshot holds of the bubbles: all that the next frame goes on from.
#include <algorithm>

#include "bubble_finder.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

void BubbleFinder::archive(StateArchive& archive) {
  const int points = topology_.points, faces = static_cast<int>(topology_.faces.size());
  archive.constant("points", static_cast<std::uint64_t>(points));
  archive.constant("faces", static_cast<std::uint64_t>(faces));
  archive.flag("fresh", fresh_);
  archive.flag("started", started_);
  archive.flag("repaint", repaint_);
  archive.number("air_at_start", total_);
  archive.number("vented", vented_);
  archive.number("vented_rest", vented_rest_);
  const auto flags = [&](const char* name, std::vector<char>& values) {
    for (char& value : values) {
      bool set = value != 0;
      archive.flag(name, set);
      if (archive.loading()) value = set;
    }
  };
  flags("touching", touching_);
  flags("airy", airy_);
  flags("reachable", reachable_);
  for (int& frames : touch_frames_) archive.integer("touch_frames", frames, 0, 2147483647);
  for (int& pocket : face_pocket_) archive.integer("face_pocket", pocket, -1, faces - 1);
  for (double& air : parked_) archive.number("parked", air, 0);
  for (double& value : saturation_) archive.number("saturation", value, 0, 1);
  archive.list("pockets", pockets_, faces, [&](AirPocket& pocket) {
    archive.number("air", pocket.air, 0);
    archive.number("side", pocket.side, -1, 1);
  });
  archive.list("bubbles", bubbles_, faces, [&](Bubble& bubble) {
    archive.flag("closed", bubble.closed);
    archive.flag("thin", bubble.thin);
    archive.flag("touched", bubble.touched);
    archive.flag("unsealed", bubble.unsealed);
    archive.flag("patch", bubble.patch);
  });
  if (!archive.loading()) return;
  bubbles_.resize(pockets_.size());
  bubble_count_ = 0;
  while (bubble_count_ < static_cast<int>(bubbles_.size()) && !bubbles_[bubble_count_].patch) ++bubble_count_;
  for (AirPocket& pocket : pockets_) pocket.side = pocket.side < 0 ? -1 : 1;
  for (int& pocket : face_pocket_) {
    if (pocket >= static_cast<int>(pockets_.size())) pocket = -1;
  }
  const bool repaint = repaint_;
  set_saturation(std::vector<double>(saturation_));
  repaint_ = repaint;
  collect_rims();
  rims_.clear();
  std::fill(adhesion_.begin(), adhesion_.end(), 0.0);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

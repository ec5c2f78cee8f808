// The times at which something begins or ends in a clip, and the stretches of keys between them.
#include <algorithm>
#include <cmath>

#include "figure_animation_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kSameInstant = 1e-9;  // s

}  // namespace

void FigureAnimation::Impl::make_ticks() {
  ticks.clear();
  frame_ticks.clear();
  const int frames = static_cast<int>(std::floor(clip.end / settings.frame_time + 1e-6)) + 1;
  std::vector<double> times;
  for (int k = 0; k < frames; ++k) times.push_back(k * settings.frame_time);
  const std::size_t regular = times.size();
  for (const auto& d : clip.dynamics) times.insert(times.end(), {d.begin, d.end});
  for (const auto& p : clip.places) times.insert(times.end(), {p.begin, p.end});
  std::vector<double> more(times.begin() + static_cast<std::ptrdiff_t>(regular), times.end());
  times.resize(regular);
  for (const double t : more) {
    const auto near = [&](double other) { return std::abs(other - t) < 1e-7; };
    if (t < times[regular - 1] && std::none_of(times.begin(), times.end(), near)) times.push_back(t);
  }
  std::sort(times.begin(), times.end());
  ticks = times;
  for (int k = 0; k < frames; ++k) {
    const auto it = std::lower_bound(ticks.begin(), ticks.end(), k * settings.frame_time - 1e-7);
    frame_ticks.push_back(static_cast<std::size_t>(it - ticks.begin()));
  }
}

void FigureAnimation::Impl::make_spline(const JointTrack& track, double from, const FigureState* start,
                                        const std::vector<double>& acceleration) {
  double until = 1e300;
  for (const DynamicInterval& d : clip.dynamics) {
    const bool takes = std::count(d.links.begin(), d.links.end(), track.link) > 0;
    if (takes && d.begin > from - kSameInstant) until = std::min(until, d.begin);
  }
  JointTrack part{track.link, track.interpolation, {}};
  if (start != nullptr) {
    const JointKind kind = model.links()[static_cast<std::size_t>(track.link)].joint;
    const auto q = start->q.begin() + model.position_offset(track.link);
    const auto v = start->qd.begin() + model.velocity_offset(track.link);
    part.keys.push_back({from, {q, q + position_count(kind)}, {v, v + velocity_count(kind)}});
  }
  bool runs_on = false;
  for (const JointKey& key : track.keys) {
    if (start != nullptr && key.time < from + 1e-6) continue;
    part.keys.push_back(key);
    if (key.time < until - 1e-7) continue;
    runs_on = until < 1e299 && key.time < until + 1e-7;
    break;
  }
  splines[static_cast<std::size_t>(track.link)].emplace(model, part, acceleration, runs_on);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

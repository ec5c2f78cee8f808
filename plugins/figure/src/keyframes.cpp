#include "softpoint/figure/keyframes.h"

#include <cmath>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

const char* name(Interpolation interpolation) {
  constexpr const char* kNames[] = {"quadratic", "cubic", "monotone", "smooth", "quintic"};
  return kNames[static_cast<int>(interpolation)];
}

void check_track(const FigureModel& model, JointTrack& track) {
  check_index("track link", track.link, model.link_count());
  const Link& link = model.links()[static_cast<std::size_t>(track.link)];
  const std::string who = "track of '" + link.name + "'";
  if (track.keys.empty()) throw Error(who + " has no keys; permitted is at least one");
  JointTrack next = track;
  const auto positions = static_cast<std::size_t>(position_count(link.joint));
  const auto rates = static_cast<std::size_t>(velocity_count(link.joint));
  for (std::size_t i = 0; i < next.keys.size(); ++i) {
    JointKey& key = next.keys[i];
    const std::string field = who + ", key " + std::to_string(i);
    check_range(field + " time", key.time, -1e6, 1e6);
    if (i > 0 && !(key.time - next.keys[i - 1].time >= 1e-6)) {
      throw Error(field + " time = " + to_text(key.time) +
                  "; permitted is 1e-06 s or more after the key before");
    }
    if (key.q.size() != positions || (!key.qd.empty() && key.qd.size() != rates)) {
      throw Error(field + " has " + std::to_string(key.q.size()) + " numbers and " +
                  std::to_string(key.qd.size()) + " rates; permitted are " + std::to_string(positions) +
                  " and 0 or " + std::to_string(rates));
    }
    for (const double x : key.q) check_range(field, x, -1e6, 1e6);
    for (const double x : key.qd) check_range(field + " rate", x, -1e6, 1e6);
    if (link.joint != JointKind::kBall && link.joint != JointKind::kFree) continue;
    double* turn = key.q.data() + (link.joint == JointKind::kFree ? 3 : 0);
    const double length = std::hypot(std::hypot(turn[0], turn[1]), std::hypot(turn[2], turn[3]));
    if (!(length > 1e-6)) {
      throw Error(field + " has a quaternion of length " + to_text(length) +
                  "; permitted is a length above 1e-06");
    }
    if (std::abs(length - 1) < 1e-15) continue;  // checked before: not a bit of it changes
    for (int k = 0; k < 4; ++k) turn[k] /= length;
  }
  track = std::move(next);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

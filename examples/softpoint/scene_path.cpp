#include "scene_path.h"

#include <algorithm>
#include <utility>

namespace softpoint::inline SOFTPOINT_ABI::scene {

Path::Path(std::vector<Keyframe> keyframes, Timing timing)
    : keyframes_(std::move(keyframes)), timing_(timing) {}

// Velocity at keyframe k of the smooth curve.
Vec3 Path::slope(std::size_t k) const {
  if (k == 0 || k + 1 == keyframes_.size()) {
    return Vec3::Zero();
  }
  const Keyframe &before = keyframes_[k - 1], &after = keyframes_[k + 1];
  return (after.value - before.value) / (after.time - before.time);
}

Vec3 Path::at(double time) const {
  if (time <= keyframes_.front().time) {
    return keyframes_.front().value;
  }
  const auto next = std::upper_bound(keyframes_.begin(), keyframes_.end(), time,
                                     [](double t, const Keyframe& key) { return t < key.time; });
  if (next == keyframes_.end()) {
    return keyframes_.back().value;
  }
  const auto k = static_cast<std::size_t>(next - keyframes_.begin()) - 1;
  const Keyframe &a = keyframes_[k], &b = *next;
  const double length = b.time - a.time;
  const double s = (time - a.time) / length;
  if (timing_ == Timing::kLinear) {
    return a.value + s * (b.value - a.value);
  }
  // Cubic Hermite basis on [0, 1].
  const double s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * a.value + (s3 - 2 * s2 + s) * length * slope(k) +
         (3 * s2 - 2 * s3) * b.value + (s3 - s2) * length * slope(k + 1);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#pragma once

#include <vector>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

struct Keyframe {
  double time = 0;  // s
  Vec3 value = Vec3::Zero();
};

enum class Timing {
  kLinear,  // straight at constant speed from keyframe to keyframe
  kSmooth,  // a cubic Hermite spline that starts and ends at rest and passes the others at their mean speed
};

// A curve through keyframes, which stand in order of time; it stays at the first before its time and at the
// last after its time.
class Path {
 public:
  Path() = default;
  Path(std::vector<Keyframe> keyframes, Timing timing);

  bool empty() const { return keyframes_.empty(); }
  double end_time() const { return keyframes_.back().time; }
  Vec3 at(double time) const;

 private:
  Vec3 slope(std::size_t k) const;

  std::vector<Keyframe> keyframes_;
  Timing timing_ = Timing::kSmooth;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

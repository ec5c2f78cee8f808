#include "scene_path.h"

#include <gtest/gtest.h>

namespace softpoint::scene {
namespace {

const std::vector<Keyframe> kKeys = {{1.0, {0, 0, 0}}, {2.0, {1, 2, 0}}, {4.0, {1, 0, 3}}};

TEST(Path, PassesItsKeyframesAndStaysAtItsEnds) {
  for (const Timing timing : {Timing::kLinear, Timing::kSmooth}) {
    const Path path(kKeys, timing);
    for (const Keyframe& key : kKeys) {
      EXPECT_LT((path.at(key.time) - key.value).norm(), 1e-15);
    }
    EXPECT_EQ(path.at(-5.0), kKeys.front().value);
    EXPECT_EQ(path.at(99.0), kKeys.back().value);
  }
}

TEST(Path, LinearGoesAtConstantSpeed) {
  const Path path(kKeys, Timing::kLinear);
  EXPECT_LT((path.at(1.25) - Vec3(0.25, 0.5, 0)).norm(), 1e-15);
  EXPECT_LT((path.at(3.0) - Vec3(1, 1, 1.5)).norm(), 1e-15);
}

TEST(Path, SmoothStartsAndEndsAtRestAndItsVelocityIsContinuous) {
  const Path path(kKeys, Timing::kSmooth);
  const auto velocity = [&](double t) { return Vec3((path.at(t + 1e-6) - path.at(t - 1e-6)) / 2e-6); };
  EXPECT_LT((path.at(1.0 + 1e-6) - path.at(1.0)).norm(), 1e-10);
  EXPECT_LT((path.at(4.0) - path.at(4.0 - 1e-6)).norm(), 1e-10);
  EXPECT_LT((velocity(2.0 - 1e-5) - velocity(2.0 + 1e-5)).norm(), 1e-3);
  EXPECT_LT((velocity(2.0) - (kKeys[2].value - kKeys[0].value) / 3.0).norm(), 1e-5);
}

}  // namespace
}  // namespace softpoint::scene

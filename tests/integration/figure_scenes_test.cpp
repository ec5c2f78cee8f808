// The scenes of the keyframe paper's figures 5 and 6, and a run-up that ends on an edge.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "metrics_recorder.h"
#include "player.h"
#include "scene_reader.h"
#include "support/tier.h"

namespace softpoint::scene {
namespace {

using figure::FigureAnimation;
using figure::PlaceEvent;

FigureSpec read_figure_scene(const std::string& name) {
  const Scene scene =
      read_scene(std::filesystem::path(SOFTPOINT_EXAMPLES_FOLDER) / "scenes" / (name + ".json"));
  EXPECT_EQ(scene.figures.size(), 1U);
  return scene.figures.front();
}

// A figure's animation and what can be read off its frames.
struct Clip {
  explicit Clip(FigureSpec of)
      : spec(std::move(of)), animation(*spec.model, spec.clip, spec.settings), placer(*spec.model) {
    animation.evaluate();
  }

  figure::LinkMotion link(const std::string& name, int frame) {
    place(frame);
    return placer.motion(spec.model->find(name));
  }
  Vec3 center(int frame) {
    place(frame);
    return placer.mechanics().center_of_mass;
  }
  // The smallest gap of a capsule to what stands around (m).
  double gap(int frame) {
    place(frame);
    figure::FigureCollision collision(*spec.model, spec.clip.capsules, spec.clip.obstacles);
    collision.place(placer);
    double least = 10;
    for (const figure::Touch& touch : collision.near(10)) least = std::min(least, touch.gap);
    return least;
  }
  int frame_of(const PlaceEvent& event) const {
    return static_cast<int>(std::lround(event.time / spec.settings.frame_time));
  }

  FigureSpec spec;
  FigureAnimation animation;
  figure::FigureDynamics placer;

 private:
  void place(int frame) { placer.place(animation.frame(frame).q.data(), animation.frame(frame).qd.data()); }
};

// The least of many evaluations from nothing, s.
double seconds_of(const FigureSpec& spec) {
  double least = 1e9;
  for (int k = 0; k < 30; ++k) {
    FigureAnimation animation(*spec.model, spec.clip, spec.settings);
    const auto start = std::chrono::steady_clock::now();
    animation.evaluate();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return least;
}

void expect_fast(const FigureSpec& spec) {
  const double seconds = seconds_of(spec);
  std::printf("    31 frames in %.0f us\n", 1e6 * seconds);
  if (!kInstrumented) {
    EXPECT_LE(seconds, 1e-3);
  }
}

TEST(FigureScenes, TheThrowSendsTheRightArmForwardAndTheLeftOneBack) {
  Clip clip(read_figure_scene("figure_throw"));
  ASSERT_EQ(clip.animation.frame_count(), 31);
  EXPECT_EQ(clip.spec.settings.limits, figure::LimitMode::kPaper);
  EXPECT_EQ(clip.animation.counts().guard_fired, 0);
  EXPECT_EQ(clip.animation.counts().dynamic_steps, 20);  // ten frames of two arms
  // Both feet stand up to the second key, then the left one alone.
  for (int k = 1; k <= 30; ++k) {
    EXPECT_LT((clip.link("left_ankle", k).position - clip.link("left_ankle", 0).position).norm(), 1e-9) << k;
    if (k > 5) continue;
    EXPECT_LT((clip.link("right_ankle", k).position - clip.link("right_ankle", 0).position).norm(), 1e-9)
        << k;
  }
  EXPECT_LT(clip.animation.counts().feet_missed, 1e-9);
  // z is forward. A hand counts from the shoulder.
  const auto reach = [&](const std::string& side, int frame) {
    return (clip.link(side + "_wrist", frame).position - clip.link(side + "_shoulder_x", frame).position)
        .eval();
  };
  EXPECT_LT(reach("right", 0).z(), 0);
  EXPECT_GT(reach("right", 15).z(), 0.3);
  EXPECT_GT(reach("right", 15).z() - reach("right", 5).z(), 0.15);
  EXPECT_GT(reach("right", 15).z() - reach("right", 0).z(), 0.5);
  EXPECT_GT(reach("left", 0).z(), 0.2);
  EXPECT_LT(reach("left", 15).z(), -0.1);
  EXPECT_LT(reach("left", 15).z() - reach("left", 5).z(), -0.2);
  expect_fast(clip.spec);
}

TEST(FigureScenes, TheJumpTakesOffAtFrame6IsHighestAt10AndLandsAt18) {
  Clip clip(read_figure_scene("figure_jump"));
  ASSERT_EQ(clip.animation.frame_count(), 31);
  const std::vector<PlaceEvent>& events = clip.animation.events();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].kind, PlaceEvent::Kind::kTakeOff);
  EXPECT_EQ(clip.frame_of(events[0]), 6);
  EXPECT_EQ(events[1].kind, PlaceEvent::Kind::kLanding);
  EXPECT_EQ(clip.frame_of(events[1]), 18);
  int top = 0;
  for (int k = 0; k <= 30; ++k) {
    if (clip.center(k).y() > clip.center(top).y()) top = k;
    EXPECT_GT(clip.gap(k), k < 18 ? -1e-6 : -0.05) << k;  // one pin lets feet sink: the paper's fault
  }
  EXPECT_EQ(top, 10);
  // The right ankle is held until take-off and after landing, from the platform to the floor.
  const auto ankle = [&](int k) { return clip.link("right_ankle", k).position; };
  for (int k = 1; k <= 5; ++k) EXPECT_LT((ankle(k) - ankle(0)).norm(), 1e-9) << k;
  for (int k = 19; k <= 30; ++k) EXPECT_LT((ankle(k) - ankle(18)).norm(), 1e-9) << k;
  EXPECT_NEAR(ankle(18).y() - ankle(0).y(), -0.27, 0.002);  // the platform's height
  EXPECT_GT(ankle(18).z() - ankle(0).z(), 0.2);
  expect_fast(clip.spec);
}

TEST(FigureScenes, TheRunUpGoesLimpInTheAirAndLandsOnTheEdge) {
  Clip clip(read_figure_scene("figure_run_up"));
  const FigureAnimation& animation = clip.animation;
  EXPECT_EQ(animation.counts().guard_fired, 0);
  const figure::Obstacle& platform = clip.spec.clip.obstacles.at(1);
  const double edge = platform.position.z() - 0.5 * platform.size.z(), height = platform.size.y();
  // Three steps, each on a foot that stands.
  const auto stands = [&](const std::string& ankle, int from, int until) {
    for (int k = from + 1; k <= until; ++k) {
      EXPECT_LT((clip.link(ankle, k).position - clip.link(ankle, from).position).norm(), 1e-9) << ankle << k;
    }
  };
  stands("right_ankle", 0, 6);
  stands("left_ankle", 6, 12);
  stands("right_ankle", 12, 19);
  // Off the ground from the take-off on, limp: first the right arm, at 20, then everything, at 26.
  ASSERT_GE(animation.events().size(), 2U);
  EXPECT_EQ(animation.events()[0].kind, PlaceEvent::Kind::kTakeOff);
  EXPECT_LE(clip.frame_of(animation.events()[0]), 20);
  EXPECT_EQ(animation.events()[1].kind, PlaceEvent::Kind::kLanding);
  EXPECT_GE(clip.frame_of(animation.events()[1]), 27);
  for (int k = 20; k <= 26; ++k) EXPECT_GT(clip.gap(k), 1e-4) << k;  // a foot just clears the edge
  const figure::FigureModel& model = *clip.spec.model;
  const auto q = [&](const std::string& joint, int k) {
    return animation.frame(k).q[static_cast<std::size_t>(model.position_offset(model.find(joint)))];
  };
  const auto key = [&](const std::string& joint) {
    for (const figure::JointTrack& track : clip.spec.clip.tracks) {
      if (track.link == model.find(joint)) return track.keys.back().q[0];  // at frame 26
    }
    return 0.0;
  };
  EXPECT_GT(std::abs(q("right_shoulder_x", 26) - key("right_shoulder_x")), 0.05);
  EXPECT_NEAR(q("left_shoulder_x", 26), key("left_shoulder_x"), 1e-5);
  for (int k = 26; k < animation.frame_count(); ++k) {
    for (const figure::Link& link : model.links()) {
      if (link.joint != figure::JointKind::kHinge) continue;
      EXPECT_GE(q(link.name, k), link.lower - 1e-10);
      EXPECT_LE(q(link.name, k), link.upper + 1e-10);
    }
  }
  // It comes down with its legs before the edge and its arms beyond it, sinks in nowhere, and lies there.
  for (int k = 19; k < animation.frame_count(); ++k) EXPECT_GT(clip.gap(k), -1e-4) << k;
  EXPECT_LT(clip.link("left_ankle", 45).position.z(), edge);
  EXPECT_LT(clip.link("right_ankle", 45).position.z(), edge);
  EXPECT_GT(clip.link("left_wrist", 45).position.z(), edge + 0.2);
  EXPECT_GT(clip.link("right_wrist", 45).position.z(), edge + 0.2);
  EXPECT_GT(clip.link("right_wrist", 45).position.y(), height);
  EXPECT_GT(clip.link("waist", 45).position.y(), height);
}

// A scene in play: the figure's bodies go through the world, its work is in the measurements.
TEST(FigureScenes, ArePlayedAndMeasured) {
  Player player(read_scene(std::filesystem::path(SOFTPOINT_EXAMPLES_FOLDER) / "scenes" / "figure_jump.json"));
  MetricsRecorder metrics(player);
  const FigureActor& actor = player.figure(0);
  const double start = actor.center().y();
  double top = start;
  while (player.frame() < player.scene().frames) {
    player.step();
    metrics.record();
    top = std::max(top, actor.center().y());
  }
  EXPECT_GT(top, start + 0.3);
  EXPECT_EQ(actor.controller().body_count(), static_cast<int>(actor.animation().clip().capsules.size()));
  const nlohmann::json measured = nlohmann::json::parse(metrics.json())["figures"][0];
  EXPECT_EQ(measured["name"], "jumper");
  EXPECT_EQ(measured["frames"], 31);
  EXPECT_EQ(measured["events"].size(), 2U);
  EXPECT_EQ(measured["events"][0]["kind"], "take-off");
  EXPECT_NEAR(measured["events"][1]["time"].get<double>(), 0.6, 1e-9);
  EXPECT_EQ(measured["narrow_tests"], measured["boxes_overlapping"]);
  EXPECT_GT(measured["narrow_tests"], 30);
}

// Handed to dynamics in mid-jump, while it is played: it flies on without a jump, knocks the box about and
// comes to rest on what there is.
TEST(FigureScenes, ARagdollOnDemandFallsAgainstABoxAndComesToRest) {
  Player player(
      read_scene(std::filesystem::path(SOFTPOINT_EXAMPLES_FOLDER) / "scenes" / "figure_ragdoll.json"));
  const FigureActor& actor = player.figure(0);
  const figure::FigureModel& model = actor.animation().model();
  figure::FigureDynamics placer(model);
  const auto lowest = [&] {
    placer.place(actor.controller().state().q.data(), actor.controller().state().qd.data());
    double low = 1e300;
    for (const figure::LinkCapsule& c : actor.animation().clip().capsules) {
      const figure::LinkMotion m = placer.motion(c.link);
      for (const Vec3& end : {c.from, c.to})
        low = std::min(low, (m.position + m.orientation * end).y() - c.radius);
    }
    return low;
  };
  const auto box = [&] { return player.rigid(2).body().getWorldTransform().getOrigin(); };
  const btVector3 stood = box();
  Vec3 velocity = actor.velocity();
  double deepest = 0;
  while (player.frame() < player.scene().frames) {
    player.step();
    const bool limp = player.time() > 0.7334 + player.scene().world.time_step;
    EXPECT_EQ(actor.controller().dynamic(0), player.time() > 0.7334) << player.time();
    if (limp && player.time() < 0.8) {  // in the air: gravity alone
      EXPECT_NEAR((actor.velocity() - velocity).y(), -9.81 * player.scene().world.time_step, 1e-6);
    }
    velocity = actor.velocity();
    if (limp) deepest = std::max(deepest, -lowest());
  }
  std::printf("    deepest in the floor %.1e m, box moved by %.2f m, figure at %.2f m, %.3f m/s\n", deepest,
              static_cast<double>((box() - stood).length()), actor.center().y(), velocity.norm());
  EXPECT_EQ(actor.controller().counts().handovers, 1);
  EXPECT_EQ(actor.controller().counts().guard_fired, 0);
  EXPECT_LE(deepest, 1e-4);
  EXPECT_GT(static_cast<double>((box() - stood).length()), 0.05);
  EXPECT_LT(actor.center().y(), 0.75);
  EXPECT_LT(velocity.norm(), 0.2);
}

}  // namespace
}  // namespace softpoint::scene

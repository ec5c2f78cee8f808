#include "scene_figure.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "scene.h"
#include "scene_figure_file.h"
#include "scene_figure_links.h"
#include "scene_limits.h"
#include "scene_rigid_reader.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using figure::Interpolation;
using figure::JointKind;
using figure::JointTrack;
using figure::Link;
using figure::PlaceRule;

constexpr double kLongestClip = 3600;  // s
constexpr double kMostSteps = 1e7;     // of a clip
constexpr double kMostAngle = 1e3;     // rad; or m, of a sliding joint

Eigen::Quaterniond turned(const Vec3& by) {
  const double angle = by.norm();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, angle > 0 ? Vec3(by / angle) : Vec3(Vec3::UnitX())));
}

double read_clip_time(ObjectReader& item, std::string_view key, const std::string& doc = "") {
  return item.number(key, {.quantity = Quantity::kTime, .low = 0, .high = kLongestClip, .doc = doc});
}

void read_settings(ObjectReader& item, const FigureLinks& parts, figure::AnimationSettings& settings) {
  const bool paper = item.choice<bool>(
      "mode", {{"paper", true}, {"exact", false}},
      {.fallback = "exact", .doc = "paper: the keyframe paper's integrator, limits, friction"});
  if (paper) {
    settings.integrator = figure::Integrator::kPaper;
    settings.limits = figure::LimitMode::kPaper;
    settings.paper_friction = parts.paper_friction;
  }
  settings.frame_time = item.number("frame_time", {.quantity = Quantity::kTime,
                                                   .low = 1e-4,
                                                   .high = 0.1,
                                                   .fallback = 1.0 / 30,
                                                   .doc = "of the animation; 1/30 s"});
  settings.substeps =
      item.integer("substeps", {.low = 1, .high = 1000, .fallback = 1, .doc = "of the dynamics, a frame"});
  settings.friction =
      item.number("contact_friction",
                  {.low = 0, .high = 100, .fallback = 0.8, .doc = "coefficient, of the rule contact"});
}

JointTrack read_base(ObjectReader& item, Interpolation kind, const std::vector<double>& times) {
  JointTrack base{0, kind, {}};
  const int count = item.list(
      "base", {.optional = true, .doc = "places of a free first link, one for each time"},
      [&](ObjectReader& key, int k) {
        const Vec3 at = key.vec3("position", {.quantity = Quantity::kLength,
                                              .low = -kMaxLength,
                                              .high = kMaxLength,
                                              .fallback = Vec3::Zero(),
                                              .doc = "of the link's frame"});
        const Vec3 turn = key.vec3("turn", {.quantity = Quantity::kAngle,
                                            .low = -kMostAngle,
                                            .high = kMostAngle,
                                            .fallback = Vec3::Zero(),
                                            .doc = "axis times angle"});
        if (key.describing() || k >= static_cast<int>(times.size())) return;
        const Eigen::Quaterniond q = turned(turn);
        base.keys.push_back(
            {times[static_cast<std::size_t>(k)], {at.x(), at.y(), at.z(), q.w(), q.x(), q.y(), q.z()}, {}});
      });
  if (!item.describing() && count > 0 && count != static_cast<int>(times.size())) {
    item.refuse("base",
                fmt::format("{} of them; permitted are {}, one for each of key_times", count, times.size()));
  }
  return base;
}

JointTrack read_track(ObjectReader& key, Interpolation kind, const std::vector<double>& times,
                      const std::vector<Link>& links) {
  JointTrack track{
      figure_link_index(key, "joint", key.text("joint", {.doc = "name of its link"}), links), kind, {}};
  const std::vector<double> values =
      key.numbers("values", {.quantity = Quantity::kAngle, .low = -kMostAngle, .high = kMostAngle},
                  {.min = 1,
                   .max = 30000,
                   .doc = "one for each time; prismatic: in m; ball: three each, axis times angle"});
  if (key.describing()) return track;
  const JointKind joint = links[static_cast<std::size_t>(track.link)].joint;
  if (joint == JointKind::kFree || joint == JointKind::kFixed) {
    key.refuse("joint", "of a free or fixed link; permitted are hinge, prismatic, ball");
  }
  const std::size_t each = joint == JointKind::kBall ? 3 : 1;
  if (values.size() != each * times.size()) {
    key.refuse("values", fmt::format("{} of them; permitted are {}, {} for each of key_times", values.size(),
                                     each * times.size(), each));
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (each == 1) {
      track.keys.push_back({times[k], {values[k]}, {}});
    } else {
      const Eigen::Quaterniond q = turned({values[3 * k], values[3 * k + 1], values[3 * k + 2]});
      track.keys.push_back({times[k], {q.w(), q.x(), q.y(), q.z()}, {}});
    }
  }
  return track;
}

figure::DynamicInterval read_interval(ObjectReader& entry, const std::vector<Link>& links) {
  figure::DynamicInterval interval;
  interval.begin = read_clip_time(entry, "begin");
  interval.end = read_clip_time(entry, "end");
  const std::string name =
      entry.text("limb", {.doc = "a link: its joint and all beyond it; of a free one all beyond it"});
  const auto limb = static_cast<std::size_t>(figure_link_index(entry, "limb", name, links));
  std::vector<char> in(links.size(), 0);
  for (std::size_t i = limb; i < links.size(); ++i) {
    const int parent = links[i].parent;
    in[i] = i == limb || (parent >= 0 && in[static_cast<std::size_t>(parent)]);
    if (in[i] && links[i].joint != JointKind::kFree) interval.links.push_back(static_cast<int>(i));
  }
  return interval;
}

figure::PlaceInterval read_place(ObjectReader& entry, const std::vector<Link>& links) {
  figure::PlaceInterval place;
  place.begin = read_clip_time(entry, "begin");
  place.end = read_clip_time(entry, "end");
  place.rule =
      entry.choice<PlaceRule>("rule",
                              {{"feet", PlaceRule::kFeet},
                               {"pin", PlaceRule::kPin},
                               {"gravity", PlaceRule::kGravity},
                               {"contact", PlaceRule::kContact},
                               {"hold", PlaceRule::kHold}},
                              {.doc = "feet: the base by its keys, legs bend; pin: a point stays; gravity: "
                                      "it stays while the figure touches something, else free flight; "
                                      "contact: by dynamics; hold: by dynamics, with points held and legs "
                                      "between them limp"});
  place.link = figure_link_index(entry, "link", entry.text("link", {.doc = "that is held"}), links);
  const std::string other =
      entry.text("other", {.fallback = "", .doc = "feet, hold: a second link that is held"});
  if (!other.empty()) place.other = figure_link_index(entry, "other", other, links);
  place.point = entry.vec3("point", {.quantity = Quantity::kLength,
                                     .low = -kMaxLength,
                                     .high = kMaxLength,
                                     .fallback = Vec3::Zero(),
                                     .doc = "of it, in its frame"});
  return place;
}

// The links of the document, or a file's.
FigureLinks read_links(ObjectReader& item, FigureSpec& spec) {
  FigureLinks parts;
  FigureFromFile file = read_figure_file(item);
  const int count = item.list("links", {.max = 1000, .optional = true, .doc = "parents first; or `model`"},
                              [&](ObjectReader& link, int) { read_figure_link(link, parts); });
  if (item.describing()) return parts;
  if (file.model == nullptr && count == 0) {
    item.refuse("links", "absent or empty; permitted are 1 to 1000 of them, or a model");
  }
  if (file.model != nullptr) {
    if (count > 0) item.refuse("links", "beside a model; permitted is one of the two");
    parts.links = file.model->links();
    parts.capsules = std::move(file.capsules);
    spec.model = std::move(file.model);
    spec.clip.tracks = std::move(file.tracks);
  }
  return parts;
}

double last_key(const figure::FigureClip& clip) {
  double last = 0;
  for (const JointTrack& track : clip.tracks) {
    if (!track.keys.empty()) last = std::max(last, track.keys.back().time);
  }
  return last;
}

// Keys of the document go before those of a motion's file.
void put_track(JointTrack track, int from_file, std::vector<JointTrack>& tracks) {
  for (int i = 0; i < from_file; ++i) {
    JointTrack& old = tracks[static_cast<std::size_t>(i)];
    if (old.link == track.link) {
      old = std::move(track);
      return;
    }
  }
  tracks.push_back(std::move(track));
}

}  // namespace

FigureSpec read_figure(ObjectReader& item, const std::vector<RigidBodySpec>& surroundings,
                       const Vec3& gravity) {
  FigureSpec spec;
  spec.name = item.text("name", {.fallback = "", .doc = "for results"});
  spec.color = read_color(item);
  FigureLinks parts = read_links(item, spec);
  spec.clip.capsules = parts.capsules;
  spec.clip.obstacles = figure_obstacles(surroundings);
  spec.settings.gravity = gravity;
  read_settings(item, parts, spec.settings);
  const auto kind =
      item.choice<Interpolation>("interpolation",
                                 {{"quadratic", Interpolation::kQuadratic},
                                  {"cubic", Interpolation::kCubic},
                                  {"monotone", Interpolation::kMonotone},
                                  {"smooth", Interpolation::kSmooth},
                                  {"quintic", Interpolation::kQuintic}},
                                 {.fallback = "cubic", .doc = "smooth, quintic: no jump of acceleration"});
  const std::vector<double> times =
      item.numbers("key_times", {.quantity = Quantity::kTime, .low = 0, .high = kLongestClip},
                   {.min = 1, .max = 10000, .optional = true, .doc = "ascending, of all keyframes"});
  const auto from_file = static_cast<int>(spec.clip.tracks.size());
  for (JointTrack& track : spec.clip.tracks) track.interpolation = kind;
  JointTrack base = read_base(item, kind, times);
  if (!base.keys.empty()) put_track(std::move(base), from_file, spec.clip.tracks);
  item.list("joints", {.optional = true, .doc = "that move; the others as the model's file says, or at 0"},
            [&](ObjectReader& key, int) {
              put_track(read_track(key, kind, times, parts.links), from_file, spec.clip.tracks);
            });
  item.list(
      "dynamic", {.optional = true, .doc = "limbs left to zero-torque dynamics for a time"},
      [&](ObjectReader& entry, int) { spec.clip.dynamics.push_back(read_interval(entry, parts.links)); });
  item.list("places",
            {.optional = true, .doc = "what the place of the whole goes by for a time; else its keys"},
            [&](ObjectReader& entry, int) { spec.clip.places.push_back(read_place(entry, parts.links)); });
  item.list(
      "handovers", {.optional = true, .doc = "limbs that go limp while the scene is played, and back"},
      [&](ObjectReader& entry, int) {
        HandOver hand;
        hand.time = read_clip_time(entry, "time");
        hand.limb = figure_link_index(
            entry, "limb",
            entry.text("limb", {.doc = "its link, with all that hangs on it: of the first one, everything"}),
            parts.links);
        hand.dynamic = entry.boolean("dynamic", {.fallback = true, .doc = "false: back to the animation"});
        spec.hand_overs.push_back(hand);
      });
  std::stable_sort(spec.hand_overs.begin(), spec.hand_overs.end(),
                   [](const HandOver& a, const HandOver& b) { return a.time < b.time; });
  const auto end = item.optional_number("end", {.quantity = Quantity::kTime,
                                                .low = 0,
                                                .high = kLongestClip,
                                                .doc = "of the animation, which begins with the scene; if "
                                                       "absent the last key"});
  if (item.describing()) return spec;
  spec.clip.end = end.value_or(last_key(spec.clip));
  const double steps = spec.clip.end / spec.settings.frame_time * spec.settings.substeps;
  if (steps > kMostSteps) {
    item.refuse("end", fmt::format("{} steps of the animation; permitted are up to {}", steps, kMostSteps));
  }
  try {
    if (!spec.model) spec.model = std::make_shared<const figure::FigureModel>(std::move(parts.links));
    figure::FigureAnimation(*spec.model, spec.clip, spec.settings);
  } catch (const Error& error) {
    item.refuse(error.what());
  }
  return spec;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

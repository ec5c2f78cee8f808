#include "scene_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <utility>

#include "scene_event_reader.h"
#include "scene_limits.h"
#include "scene_rigid_reader.h"
#include "scene_view_reader.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr int kMaxFrames = 1000000;

void read_contact(ObjectReader& item, ContactSettings& contact) {
  contact.margin = item.number("margin", {.quantity = Quantity::kLength,
                                          .low = 1e-5,
                                          .high = 0.1,
                                          .fallback = contact.margin,
                                          .doc = "gap kept between skin and rigid shape"});
  contact.tolerance =
      item.number("tolerance", {.quantity = Quantity::kLength,
                                .low = 1e-12,
                                .high = 1e-2,
                                .fallback = contact.tolerance,
                                .doc = "a sweep that moves no contact by more ends the solve"});
  contact.max_iterations =
      item.integer("max_iterations",
                   {.low = 1, .high = 10000, .fallback = contact.max_iterations, .doc = "sweeps a pass"});
  contact.max_passes = item.integer(
      "max_passes",
      {.low = 1, .high = 20, .fallback = contact.max_passes, .doc = "rounds of detection a substep"});
  contact.rebound_speed = item.number("rebound_speed", {.quantity = Quantity::kVelocity,
                                                        .low = 0.0,
                                                        .high = kMaxSpeed,
                                                        .fallback = contact.rebound_speed,
                                                        .doc = "slower impacts do not bounce"});
  contact.rigid_support = item.boolean(
      "rigid_support",
      {.fallback = contact.rigid_support, .doc = "solve rigid contacts of touched piles together with ours"});
}

void read_world(ObjectReader& item, WorldSpec& world) {
  world.kind = item.choice<WorldKind>("kind",
                                      {{"discrete", WorldKind::kDiscrete},
                                       {"multibody", WorldKind::kMultiBody},
                                       {"softrigid", WorldKind::kSoftRigid},
                                       {"softmultibody", WorldKind::kSoftMultiBody},
                                       {"deformable", WorldKind::kDeformable}},
                                      {.fallback = "discrete", .doc = "which of Bullet's stock worlds"});
  world.gravity = item.vec3("gravity", {.quantity = Quantity::kAcceleration,
                                        .low = -kMaxAcceleration,
                                        .high = kMaxAcceleration,
                                        .fallback = world.gravity});
  world.time_step = item.number("time_step", {.quantity = Quantity::kTime,
                                              .low = 1e-5,
                                              .high = 0.1,
                                              .fallback = world.time_step,
                                              .doc = "of a frame; 1/60 s"});
  world.substeps = item.integer(
      "substeps", {.low = 1, .high = 1000, .fallback = world.substeps, .doc = "equal steps a frame"});
  world.solver_iterations = item.integer(
      "solver_iterations",
      {.low = 1, .high = 10000, .fallback = world.solver_iterations, .doc = "of Bullet's solver"});
  item.optional_object("contact", "of deformables",
                       [&](ObjectReader& contact) { read_contact(contact, world.contact); });
}

DeformableSpec read_deformable(ObjectReader& item, const DeformablePlugins& plugins, const Scene& scene) {
  DeformableSpec body;
  body.name = item.text("name", {.fallback = "", .doc = "unique; for events and results"});
  body.placement = read_placement(item);
  body.motion = read_motion(item);
  body.friction = item.number(
      "friction",
      {.low = 0.0, .high = 100.0, .fallback = 0.5, .doc = "coefficient; the product of both bodies' counts"});
  body.restitution = item.number(
      "restitution", {.low = 0.0, .high = 1.0, .fallback = 0.0, .doc = "the product of both bodies' counts"});
  body.may_sleep =
      item.boolean("may_sleep", {.fallback = true, .doc = "it may be stopped with all it touches when slow"});
  body.color = read_color(item);
  body.look = item.choice<Look>(
      "look", {{"solid", Look::kSolid}, {"edges", Look::kEdges}, {"hidden", Look::kHidden}},
      {.fallback = "solid", .doc = "edges: a wire frame of its edges, without diagonals of flat quads"});
  std::vector<Variant> variants;
  for (const DeformablePlugin& plugin : plugins) {
    std::string doc = plugin.doc;
    for (const std::string& name : plugin.switches) {
      doc += (&name == &plugin.switches.front() ? " (switches: " : ", ") + name;
    }
    doc += plugin.switches.empty() ? "" : ")";
    variants.push_back({plugin.name, doc, [&body, &plugin, &scene](ObjectReader& reader) {
                          body.plugin = plugin.name;
                          body.switches = plugin.switches;
                          DeformablePlan plan = plugin.read(reader, scene);
                          body.vertex_count = plan.vertex_count;
                          body.parts = std::move(plan.parts);
                          body.taken_ends = std::move(plan.taken_ends);
                          body.make = std::move(plan.make);
                        }});
  }
  item.variant("plugin", variants, {.doc = "which plugin makes the body"});
  return body;
}

// Names are unique over all bodies; a body without one is called by what it is and its number.
class Names {
 public:
  void settle(ObjectReader& item, std::string& name, const std::string& kind, int index) {
    if (name.empty()) {
      name = fmt::format("{} {}", kind, index);
    }
    if (!item.describing() && !taken_.insert(name).second) {
      item.refuse("name",
                  fmt::format("\"{}\" is the name of another body too; permitted are unique names", name));
    }
  }

 private:
  std::set<std::string> taken_;
};

void read_length(ObjectReader& root, Scene& scene) {
  const auto duration = root.optional_number("duration", {.quantity = Quantity::kTime,
                                                          .low = 0.0,
                                                          .high = kMaxTime,
                                                          .above = true,
                                                          .doc = "of the scene; or frames"});
  const auto frames = root.optional_integer(
      "frames", {.low = 1, .high = kMaxFrames, .doc = "steps of the scene; the command line goes before"});
  if (root.describing()) {
    return;
  }
  if (duration.has_value() == frames.has_value()) {
    root.refuse("permitted is one of: duration, frames");
  }
  const double count = duration ? std::ceil(*duration / scene.world.time_step - 1e-9) : *frames;
  if (count > kMaxFrames) {
    root.refuse("duration", fmt::format("{} frames; permitted are up to {}", to_text(count), kMaxFrames));
  }
  scene.frames = static_cast<int>(count);
}

}  // namespace

void read_scene(ObjectReader& root, const DeformablePlugins& plugins, Scene& scene) {
  scene.file = root.document();
  root.text("description", {.fallback = "", .doc = "for readers of the file"});
  root.optional_object("world", "y is up", [&](ObjectReader& item) { read_world(item, scene.world); });
  Names names;
  root.list("rigid_bodies", {.optional = true}, [&](ObjectReader& item, int index) {
    RigidBodySpec body = read_rigid_body(item);
    names.settle(item, body.name, "rigid", index);
    scene.rigid_bodies.push_back(std::move(body));
  });
  root.list("deformables", {.optional = true}, [&](ObjectReader& item, int index) {
    DeformableSpec body = read_deformable(item, plugins, scene);
    names.settle(item, body.name, "deformable", index);
    scene.deformables.push_back(std::move(body));
  });
  root.list("figures", {.optional = true, .doc = "keyframed, with dynamics inside; kinematic to all others"},
            [&](ObjectReader& item, int index) {
              FigureSpec spec = read_figure(item, scene.rigid_bodies, scene.world.gravity);
              names.settle(item, spec.name, "figure", index);
              scene.figures.push_back(std::move(spec));
            });
  read_events(root, scene);
  read_view(root, scene);
  read_length(root, scene);
}

Scene read_scene(const std::filesystem::path& path) {
  Scene scene;
  const DeformablePlugins plugins = deformable_plugins();
  read_json_file(path, [&](ObjectReader& root) { read_scene(root, plugins, scene); });
  return scene;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

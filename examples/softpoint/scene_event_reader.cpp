#include "scene_event_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "json_reader_state.h"
#include "nearest.h"
#include "scene_body_ref.h"
#include "scene_character_shapes.h"
#include "scene_event_order.h"
#include "scene_limits.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

class EventReader {
 public:
  explicit EventReader(Scene& scene) : scene_(scene) {}

  void read(ObjectReader& item);
  // Of the events in the document, for messages.
  const std::vector<std::string>& places() const { return places_; }

 private:
  void read_grab(ObjectReader& item);
  void read_pin(ObjectReader& item);
  void read_attach(ObjectReader& item);
  void read_hold(ObjectReader& item);
  void read_points(ObjectReader& item, GrabEvent& event);
  double read_max_force(ObjectReader& item, const std::string& doc);
  static Vec3Spec turn_spec(const std::string& with);
  static void read_keyframe(ObjectReader& item, int index, bool with_to, MoveEvent& move);
  void read_move(ObjectReader& item);
  void read_impulse(ObjectReader& item);
  void read_toggle(ObjectReader& item);
  int read_new_handle(ObjectReader& item);
  int read_handle(ObjectReader& item);
  bool read_near_frame(ObjectReader& item);
  void add(ObjectReader& item, Event event);

  Scene& scene_;
  double at_ = 0;
  std::vector<std::string> places_;
};

const char* const kHandleDoc = "name of the handle";
const char* const kNearDoc = "the vertex nearest to this position at that time";

int EventReader::read_new_handle(ObjectReader& item) {
  const std::string name = item.text("handle", {.doc = "name for the handle, for later events"});
  if (name.empty() && !item.describing()) {
    item.refuse("handle", "permitted is any text but the empty one");
  }
  const auto found = std::find(scene_.handles.begin(), scene_.handles.end(), name);
  const int index = static_cast<int>(found - scene_.handles.begin());
  if (found == scene_.handles.end()) {
    scene_.handles.push_back(name);
  }
  return index;
}

int EventReader::read_handle(ObjectReader& item) {
  const std::string name = item.text("handle", {.doc = kHandleDoc});
  const auto found = std::find(scene_.handles.begin(), scene_.handles.end(), name);
  if (found == scene_.handles.end() && !item.describing()) {
    const std::string meant = nearest(name, scene_.handles);
    item.refuse("handle",
                scene_.handles.empty()
                    ? "no event before this one grabs, pins or holds anything"
                    : fmt::format("permitted are handles of events before: {}{}", joined(scene_.handles),
                                  meant.empty() ? "" : "; did you mean \"" + meant + "\"?"));
  }
  return static_cast<int>(found - scene_.handles.begin());
}

bool EventReader::read_near_frame(ObjectReader& item) {
  return item.choice<bool>("near_in", {{"world", false}, {"body", true}},
                           {.fallback = "world", .doc = "body: counted from its centre of mass, unturned"});
}

void EventReader::read_grab(ObjectReader& item) {
  GrabEvent grab;
  grab.handle = read_new_handle(item);
  grab.deformable = read_body_ref(item, "body", scene_, true, "name of a deformable").index;
  const int count =
      item.describing() ? 1 : scene_.deformables[static_cast<std::size_t>(grab.deformable)].vertex_count;
  const auto vertex = item.optional_integer(
      "vertex", {.low = 0,
                 .high = item.describing() ? std::numeric_limits<int>::max() : count - 1,
                 .doc = "counted from 0; or near"});
  const auto near = item.optional_vec3(
      "near", {.quantity = Quantity::kLength, .low = -kMaxPlace, .high = kMaxPlace, .doc = kNearDoc});
  if (!item.describing() && vertex.has_value() == near.has_value()) {
    item.refuse("permitted is one of: vertex, near");
  }
  if (vertex) {
    grab.vertices = {*vertex};
  }
  grab.near = near.value_or(Vec3::Zero());
  grab.near_body = read_near_frame(item);
  grab.max_force = read_max_force(item, "strongest pull; without it the vertex follows exactly");
  add(item, {at_, grab});
}

void EventReader::read_pin(ObjectReader& item) {
  GrabEvent pin;
  pin.max_force = kNoLimit;
  pin.handle = read_new_handle(item);
  pin.deformable = read_body_ref(item, "body", scene_, true, "name of a deformable").index;
  read_points(item, pin);
  add(item, {at_, pin});
}

void EventReader::read_attach(ObjectReader& item) {
  GrabEvent attach;
  attach.handle = read_new_handle(item);
  attach.deformable = read_body_ref(item, "body", scene_, true, "name of a deformable").index;
  const BodyRef to = read_body_ref(item, "to", scene_, false, "name of a rigid body");
  if (to.deformable && !item.describing()) {
    item.refuse("to", "permitted is a rigid body");
  }
  attach.to = to.index;
  read_points(item, attach);
  attach.max_force = read_max_force(item, "strongest pull on each vertex; without it they are held exactly");
  attach.collide = item.boolean("collide", {.fallback = false, .doc = "the two bodies still collide"});
  add(item, {at_, attach});
}

void EventReader::read_hold(ObjectReader& item) {
  HoldEvent hold;
  hold.handle = read_new_handle(item);
  hold.deformable = read_body_ref(item, "body", scene_, true, "name of a character").index;
  const std::string part = item.text("part", {.doc = "name of a part of it"});
  const bool tip = item.choice<bool>("end", {{"root", false}, {"tip", true}}, {.doc = "of the part's bone"});
  hold.surface = item.choice<bool>(
      "by", {{"surface", true}, {"point", false}},
      {.fallback = "surface", .doc = "point: the end of the bone alone, round which the surface may turn"});
  if (!item.describing()) {
    const DeformableSpec& body = scene_.deformables[static_cast<std::size_t>(hold.deformable)];
    hold.end = 2 * find_name(item, "part", part, body.parts) + (tip ? 1 : 0);
    if (const std::string& why = body.taken_ends[static_cast<std::size_t>(hold.end)]; !why.empty()) {
      item.refuse("end", "this end " + why + "; permitted are free ends");
    }
  }
  add(item, {at_, hold});
}

double EventReader::read_max_force(ObjectReader& item, const std::string& doc) {
  return item
      .optional_number(
          "max_force",
          {.quantity = Quantity::kForce, .low = 0.0, .high = kMaxForce, .above = true, .doc = doc})
      .value_or(kNoLimit);
}

// Several vertices of event.deformable.
void EventReader::read_points(ObjectReader& item, GrabEvent& event) {
  const bool by_vertices = item.has("vertices"), by_near = item.has("near");
  if (!item.describing() && by_vertices == by_near) {
    item.refuse("permitted is one of: vertices, near");
  }
  if (by_vertices || item.describing()) {
    event.vertices = item.indices(
        "vertices",
        {.count = item.describing()
                      ? 1
                      : scene_.deformables[static_cast<std::size_t>(event.deformable)].vertex_count,
         .of = "vertices of the body",
         .doc = "or near"});
  }
  event.near =
      item.optional_vec3(
              "near", {.quantity = Quantity::kLength, .low = -kMaxPlace, .high = kMaxPlace, .doc = kNearDoc})
          .value_or(Vec3::Zero());
  event.radius = item.number("radius", {.quantity = Quantity::kLength,
                                        .low = 0.0,
                                        .high = kMaxLength,
                                        .fallback = 0.0,
                                        .doc = "with near: all vertices within it too"});
  event.near_body = read_near_frame(item);
}

Vec3Spec EventReader::turn_spec(const std::string& with) {
  return {.quantity = Quantity::kAngle,
          .low = -kMaxAngle,
          .high = kMaxAngle,
          .doc = with + "of a handle that holds the surface of an end: axis times angle, from the rest pose"};
}

void EventReader::read_keyframe(ObjectReader& item, int index, bool with_to, MoveEvent& move) {
  Keyframe frame;
  frame.time =
      item.number("time", {.quantity = Quantity::kTime, .low = 0.0, .high = kMaxTime, .above = true});
  frame.value = item.vec3("position", {.quantity = Quantity::kLength, .low = -kMaxPlace, .high = kMaxPlace});
  const auto turn = item.optional_vec3("turn", turn_spec("in all keyframes or none, "));
  if (item.describing()) {
    return;
  }
  if (!move.keyframes.empty() && frame.time <= move.keyframes.back().time) {
    item.refuse("time", with_to ? "permitted are to and duration, or keyframes, not both"
                                : "permitted are times in rising order");
  }
  if (index > 0 && turn.has_value() == move.turns.empty()) {
    item.refuse("turn", "permitted in all keyframes or none");
  }
  move.keyframes.push_back(frame);
  if (turn) move.turns.push_back({frame.time, *turn});
}

void EventReader::read_move(ObjectReader& item) {
  MoveEvent move;
  move.handle = read_handle(item);
  move.origin = item.choice<Origin>(
      "from", {{"world", Origin::kWorld}, {"handle", Origin::kHandle}, {"body", Origin::kBody}},
      {.fallback = "world",
       .doc = "what positions count from: the world, where the handle is when this begins, or the centre of "
              "mass "
              "of its body then"});
  move.timing = item.choice<Timing>("timing", {{"smooth", Timing::kSmooth}, {"linear", Timing::kLinear}},
                                    {.fallback = "smooth", .doc = "smooth starts and ends at rest"});
  const auto to = item.optional_vec3("to", {.quantity = Quantity::kLength,
                                            .low = -kMaxPlace,
                                            .high = kMaxPlace,
                                            .doc = "with duration; or keyframes"});
  const auto duration = item.optional_number(
      "duration",
      {.quantity = Quantity::kTime, .low = 0.0, .high = kMaxTime, .above = true, .doc = "with to"});
  const auto turn = item.optional_vec3("turn", turn_spec("with to, "));
  if (to.has_value() != duration.has_value()) {
    item.refuse("permitted are to and duration together, or keyframes");
  }
  if (to) {
    move.keyframes = {{*duration, *to}};
  }
  if (turn && !item.describing()) {
    if (!to) item.refuse("turn", "permitted with to and duration");
    move.turns = {{*duration, *turn}};
  }
  item.list("keyframes", {.min = 1, .optional = true, .doc = "positions at times after the event"},
            [&](ObjectReader& key, int index) { read_keyframe(key, index, to.has_value(), move); });
  if (!item.describing() && (move.keyframes.empty() || (to && item.has("keyframes")))) {
    item.refuse("permitted is one of: to and duration, keyframes");
  }
  add(item, {at_, move});
}

void EventReader::read_impulse(ObjectReader& item) {
  ImpulseEvent event;
  event.body = read_body_ref(item, "body", scene_, false, "name of a body");
  event.impulse =
      item.vec3("impulse", {.quantity = Quantity::kImpulse, .low = -kMaxImpulse, .high = kMaxImpulse});
  event.near = item.optional_vec3(
      "near", {.quantity = Quantity::kLength,
               .low = -kMaxPlace,
               .high = kMaxPlace,
               .doc = "acts there (deformable: at the nearest vertex); absent: through the centre of mass"});
  event.near_body = read_near_frame(item);
  add(item, {at_, event});
}

void EventReader::read_toggle(ObjectReader& item) {
  ToggleEvent event;
  const auto plain = [&](SwitchKind kind) { return [&event, kind](ObjectReader&) { event.what = kind; }; };
  item.variant("what",
               {{"body", "take it out of the world, or put it back",
                 [&](ObjectReader& reader) {
                   event.what = SwitchKind::kBody;
                   event.body = read_body_ref(reader, "body", scene_, false, "name of a body");
                 }},
                {"gravity", "of the world", plain(SwitchKind::kGravity)},
                {"contacts", "in pictures", plain(SwitchKind::kContacts)},
                {"forces", "in pictures", plain(SwitchKind::kForces)},
                {"wireframe", "in pictures", plain(SwitchKind::kWireframe)},
                {"plugin", "a switch of the body's plugin",
                 [&](ObjectReader& reader) {
                   event.what = SwitchKind::kPlugin;
                   event.body = read_body_ref(reader, "body", scene_, true, "name of a deformable");
                   event.switch_name = reader.text("switch", {.doc = "see the plugin"});
                   if (reader.describing()) {
                     return;
                   }
                   const auto& names =
                       scene_.deformables[static_cast<std::size_t>(event.body.index)].switches;
                   if (std::find(names.begin(), names.end(), event.switch_name) == names.end()) {
                     reader.refuse("switch", "permitted is one of " + joined(names));
                   }
                 }}},
               {});
  event.on = item.optional_boolean("on", {.doc = "absent: the other way"});
  add(item, {at_, event});
}

void EventReader::add(ObjectReader& item, Event event) {
  if (!item.describing()) {
    scene_.events.push_back(std::move(event));
    places_.push_back(item.document() + ": " + item.path());
  }
}

void EventReader::read(ObjectReader& item) {
  at_ = item.number("at", {.quantity = Quantity::kTime, .low = 0.0, .high = kMaxTime, .doc = "when"});
  item.variant(
      "do",
      {{"grab", "hold a vertex where it is", [&](ObjectReader& r) { read_grab(r); }},
       {"pin", "hold vertices where they are", [&](ObjectReader& r) { read_pin(r); }},
       {"attach", "tie vertices to a rigid body where they are", [&](ObjectReader& r) { read_attach(r); }},
       {"hold", "hold an end of a part of a character where it is", [&](ObjectReader& r) { read_hold(r); }},
       {"move", "lead a handle", [&](ObjectReader& r) { read_move(r); }},
       {"release", "let go",
        [&](ObjectReader& r) {
          add(r, {at_, ReleaseEvent{read_handle(r)}});
        }},
       {"impulse", "strike a body", [&](ObjectReader& r) { read_impulse(r); }},
       {"toggle", "switch something on or off", [&](ObjectReader& r) { read_toggle(r); }}},
      {});
}

}  // namespace

void read_events(ObjectReader& root, Scene& scene) {
  EventReader reader(scene);
  root.list("events", {.optional = true, .doc = "what happens when; those of one time in order of the file"},
            [&](ObjectReader& item, int) { reader.read(item); });
  check_event_order(scene, reader.places());
  std::stable_sort(scene.events.begin(), scene.events.end(),
                   [](const Event& a, const Event& b) { return a.at < b.at; });
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "articulation.h"
#include "scene_figure.h"
#include "scene_path.h"
#include "sheet.h"
#include "softpoint/core/deformable_system.h"
#include "softpoint/core/triangle_mesh.h"

// A scene as read from its file: plain data, SI units, y up. What each field means to the author of a
// scene stands with the readers.
namespace softpoint::inline SOFTPOINT_ABI::scene {

enum class WorldKind { kDiscrete, kMultiBody, kSoftRigid, kSoftMultiBody, kDeformable };

struct WorldSpec {
  WorldKind kind = WorldKind::kDiscrete;
  Vec3 gravity{0.0, -9.81, 0.0};  // m/s2
  double time_step = 1.0 / 60.0;  // s, of a frame
  int substeps = 1;               // equal steps a frame
  int solver_iterations = 10;     // of Bullet's rigid solver
  ContactSettings contact;

  double substep() const { return time_step / substeps; }
};

// x -> rotation x + position.
struct Placement {
  Vec3 position = Vec3::Zero();  // m
  Mat3 rotation = Mat3::Identity();

  Vec3 to_world(const Vec3& local) const { return rotation * local + position; }
  Vec3 to_local(const Vec3& world) const { return rotation.transpose() * (world - position); }
};

struct Motion {
  Vec3 linear = Vec3::Zero();   // m/s, of the centre of mass
  Vec3 angular = Vec3::Zero();  // rad/s
};

struct ShapePart;

enum class ShapeKind { kBox, kSphere, kCapsule, kCylinder, kCone, kPlane, kHull, kMesh, kCompound };

struct ShapeSpec {
  ShapeKind kind = ShapeKind::kBox;
  Vec3 size = Vec3::Ones();         // m, whole edges of a box
  double radius = 0;                // m
  double length = 0;                // m: cylinder, cone; of a capsule without its half spheres
  int axis = 1;                     // of capsule, cylinder, cone
  Vec3 normal = Vec3::UnitY();      // of a plane
  double offset = 0;                // m, of a plane
  std::vector<Vec3> points;         // m, of a hull or mesh
  std::vector<Triangle> triangles;  // of a mesh
  std::vector<ShapePart> parts;     // of a compound, none of them a compound
};

struct ShapePart {
  ShapeSpec shape;
  Placement placement;
};

using Rgb = Vec3;  // 0 to 1, sRGB-encoded

struct RigidBodySpec {
  std::string name;
  ShapeSpec shape;
  double mass = 0;  // kg; 0 never moves
  Placement placement;
  Motion motion;
  double friction = 0.5, restitution = 0, rolling_friction = 0;
  double linear_damping = 0, angular_damping = 0;  // share of speed lost in a second
  bool may_sleep = true;
  bool visible = true;
  std::optional<Rgb> color;
};

// A deformable in play, and what of it a scene may switch.
struct DeformableActor {
  std::unique_ptr<Deformable> body;
  std::map<std::string, std::function<void(bool)>> switches;
  std::unique_ptr<Articulation> articulation;  // of a body of parts
  std::unique_ptr<Sheet> sheet;                // of a cloth
};

// What making a deformable starts from. `before`: the bodies before it in the scene, made already.
struct MakeContext {
  const WorldSpec& world;
  Placement placement;
  Motion motion;
  std::span<const DeformableActor> before;
};
using MakeDeformable = std::function<DeformableActor(const MakeContext&)>;

// How a deformable is drawn.
enum class Look { kSolid, kEdges, kHidden };

struct DeformableSpec {
  std::string name, plugin;
  Placement placement;
  Motion motion;
  double friction = 0.5, restitution = 0;
  bool may_sleep = true;
  std::optional<Rgb> color;
  Look look = Look::kSolid;
  int vertex_count = 0;
  std::vector<std::string> switches;
  std::vector<std::string> parts;       // names, of a body of parts
  std::vector<std::string> taken_ends;  // per end, why it cannot be held; "" if it can
  MakeDeformable make;
};

struct BodyRef {
  bool deformable = false;
  int index = 0;
};

struct GrabEvent {  // one point, or several that stay together
  int handle = 0;
  int deformable = 0;
  std::vector<int> vertices;  // empty: chosen by `near`
  Vec3 near = Vec3::Zero();   // m
  double radius = 0;          // m; 0: the nearest vertex alone
  bool near_body = false;     // `near` counts from the centre of mass
  double max_force = 0;       // N, of each point; infinity pins
  std::optional<int> to;      // a rigid body that carries the points; absent: the world
  bool collide = false;       // with that body
};

struct HoldEvent {  // an end of a part
  int handle = 0;
  int deformable = 0;
  int end = 0;  // 2 part + (tip ? 1 : 0)
  bool surface = true;
};

enum class Origin { kWorld, kHandle, kBody };

struct MoveEvent {
  int handle = 0;
  Origin origin = Origin::kWorld;
  Timing timing = Timing::kSmooth;
  std::vector<Keyframe> keyframes;  // times from the event on
  std::vector<Keyframe> turns;      // axis times angle (rad), at the same times; empty: none
};

struct ReleaseEvent {
  int handle = 0;
};

struct ImpulseEvent {
  BodyRef body;
  Vec3 impulse = Vec3::Zero();  // N s
  std::optional<Vec3> near;     // m; absent: through the centre of mass
  bool near_body = false;
};

enum class SwitchKind { kBody, kGravity, kContacts, kForces, kWireframe, kPlugin };

struct ToggleEvent {
  SwitchKind what = SwitchKind::kGravity;
  BodyRef body;             // kBody, kPlugin
  std::string switch_name;  // kPlugin
  std::optional<bool> on;   // absent: the other way
};

struct Event {
  double at = 0;  // s
  std::variant<GrabEvent, HoldEvent, MoveEvent, ReleaseEvent, ImpulseEvent, ToggleEvent> action;
};

struct CameraSpec {
  Vec3 eye{4.0, 3.0, 6.0};
  Vec3 target{0.0, 0.5, 0.0};
  Vec3 up{0.0, 1.0, 0.0};
  double fov = 0.7;  // rad, vertical
  std::optional<BodyRef> follow;
  Path eye_path, target_path;  // empty: none
};

// What is drawn over the bodies.
struct Overlays {
  bool contacts = false, forces = false, wireframe = false, time = true;
};

struct PictureSpec {
  int every = 0;              // frames; 0: at `times` alone
  std::vector<double> times;  // s
  int width = 1280, height = 720;
  bool sheet = true;
  int sheet_columns = 4, sheet_cell_width = 320;
  Overlays overlays;
  double meters_per_newton = 0.002;
  std::string text;
  double video_fps = 0;  // 0: one a frame of the world
  int video_quality = 20;
};

struct Scene {
  std::string file;
  WorldSpec world;
  std::vector<RigidBodySpec> rigid_bodies;
  std::vector<DeformableSpec> deformables;
  std::vector<FigureSpec> figures;
  std::vector<std::string> handles;  // names
  std::vector<Event> events;         // in order of time
  CameraSpec camera;
  PictureSpec pictures;
  int frames = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#include "scene_figure_links.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <optional>

#include "scene.h"
#include "scene_limits.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using figure::JointKind;
using figure::Link;
using figure::Obstacle;

constexpr double kMostInertia = 1e6;  // kg m2, kg, N m s, N m

// The mass as a cylinder from `from` to `tip`, which need not lie along an axis of the link.
void give_cylinder(Link& link, const Vec3& from, const Vec3& tip, double radius) {
  const Vec3 along = tip - from;
  const double length = along.norm();
  const Vec3 u = length > 0 ? Vec3(along / length) : Vec3(Vec3::UnitZ());
  Link cylinder;
  figure::set_cylinder(cylinder, link.mass, radius, length);
  const double across = cylinder.inertia(0, 0), about = cylinder.inertia(2, 2);
  link.center_of_mass = 0.5 * (from + tip);
  link.inertia = across * Mat3::Identity() + (about - across) * u * u.transpose();
}

void read_joint(ObjectReader& item, Link& link) {
  link.joint =
      item.choice<JointKind>("joint",
                             {{"hinge", JointKind::kHinge},
                              {"prismatic", JointKind::kPrismatic},
                              {"ball", JointKind::kBall},
                              {"fixed", JointKind::kFixed},
                              {"free", JointKind::kFree}},
                             {.fallback = "hinge", .doc = "free: of a first link that goes anywhere"});
  link.axis = item.vec3("axis", {.low = -1,
                                 .high = 1,
                                 .fallback = Vec3::UnitZ(),
                                 .doc = "of hinge and prismatic; of the twist of a ball with a cone"});
  link.origin = item.vec3("origin", {.quantity = Quantity::kLength,
                                     .low = -kMaxLength,
                                     .high = kMaxLength,
                                     .fallback = Vec3::Zero(),
                                     .doc = "of the joint, in the parent's frame"});
  link.lower =
      item.number("lower", {.quantity = Quantity::kAngle,
                            .low = -1e9,
                            .high = 1e9,
                            .fallback = -1e9,
                            .doc = "of the range while the joint is dynamic; of prismatic in m, of a ball "
                                   "with a cone its twist (-3 to 3 rad)"});
  link.upper =
      item.number("upper", {.quantity = Quantity::kAngle, .low = -1e9, .high = 1e9, .fallback = 1e9});
  link.swing_about = item.number("swing_about", {.quantity = Quantity::kAngle,
                                                 .low = figure::kLeastSwing,
                                                 .high = 1e9,
                                                 .fallback = 1e9,
                                                 .doc = "of a ball: half angle of its cone, of swings about "
                                                        "swing_axis, up to 3 rad; 1e9: free"});
  link.swing_across = item.number("swing_across", {.quantity = Quantity::kAngle,
                                                   .low = figure::kLeastSwing,
                                                   .high = 1e9,
                                                   .fallback = 1e9,
                                                   .doc = "of swings across it; given with swing_about"});
  link.swing_axis = item.vec3(
      "swing_axis",
      {.low = -1, .high = 1, .fallback = Vec3::Zero(), .doc = "in the link's frame, across axis; zero: any"});
  link.armature = item.number("armature", {.low = 0,
                                           .high = kMostInertia,
                                           .fallback = 0,
                                           .doc = "kg m2 (prismatic kg), the joint's own inertia"});
  link.damping = item.number(
      "damping", {.low = 0, .high = kMostInertia, .fallback = 0, .doc = "N m s (N s/m), viscous friction"});
  link.friction = item.number("dry_friction", {.low = 0,
                                               .high = kMostInertia,
                                               .fallback = 0,
                                               .doc = "N m (N), of hinge and prismatic in mode exact"});
}

std::optional<Obstacle> obstacle_of(const RigidBodySpec& body) {
  Obstacle o;
  o.position = body.placement.position;
  o.orientation = body.placement.rotation;
  switch (body.shape.kind) {
    case ShapeKind::kPlane:
      return figure::half_space(body.placement.to_world(body.shape.offset * body.shape.normal),
                                body.placement.rotation * body.shape.normal);
    case ShapeKind::kBox:
      o.kind = Obstacle::Kind::kBox;
      o.size = body.shape.size;
      return o;
    case ShapeKind::kSphere:
      o.kind = Obstacle::Kind::kCapsule;
      o.radius = body.shape.radius;
      return o;
    case ShapeKind::kCapsule:
      o.kind = Obstacle::Kind::kCapsule;
      o.radius = body.shape.radius;
      o.length = body.shape.length;
      o.orientation *= Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), Vec3(Vec3::Unit(body.shape.axis)))
                           .toRotationMatrix();
      return o;
    default:
      return std::nullopt;
  }
}

}  // namespace

int figure_link_index(const ObjectReader& item, std::string_view key, const std::string& name,
                      const std::vector<Link>& links) {
  if (item.describing()) return 0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i].name == name) return static_cast<int>(i);
  }
  item.refuse(key, fmt::format("\"{}\" is no link; permitted are names of links read before", name));
}

void read_figure_link(ObjectReader& item, FigureLinks& parts) {
  Link link;
  link.name = item.text("name", {.doc = "unique in the figure; the joint that carries the link has it too"});
  for (const Link& other : parts.links) {
    if (!item.describing() && other.name == link.name) {
      item.refuse("name",
                  fmt::format("\"{}\" is the name of another link; permitted are unique names", link.name));
    }
  }
  const std::string parent =
      item.text("parent", {.fallback = "", .doc = "name of an earlier link; none: the world"});
  if (!parent.empty()) link.parent = figure_link_index(item, "parent", parent, parts.links);
  read_joint(item, link);
  const Vec3 from = item.vec3("from", {.quantity = Quantity::kLength,
                                       .low = -kMaxLength,
                                       .high = kMaxLength,
                                       .fallback = Vec3::Zero(),
                                       .doc = "where the link begins, in its frame"});
  const auto tip = item.optional_vec3("tip", {.quantity = Quantity::kLength,
                                              .low = -kMaxLength,
                                              .high = kMaxLength,
                                              .doc = "where it ends; a link without has no shape"});
  const double radius = item.number("radius", {.quantity = Quantity::kLength,
                                               .low = 1e-4,
                                               .high = 100,
                                               .fallback = 0.05,
                                               .doc = "of the capsule that it is drawn and touched as"});
  link.mass =
      item.number("mass", {.quantity = Quantity::kMass,
                           .low = 0,
                           .high = 1e6,
                           .fallback = 0,
                           .doc = "of a cylinder from `from` to `tip`; 0 between hinges of one joint"});
  const double factor = item.number(
      "friction", {.low = 0,
                   .high = 1,
                   .fallback = 1,
                   .doc = "factor of the joint's speed in 1/30 s; by viscous friction but in mode paper"});
  const int index = static_cast<int>(parts.links.size());
  if (factor < 1) parts.paper_friction.emplace_back(index, factor);
  if (tip && !item.describing()) {
    give_cylinder(link, from, *tip, radius);
    parts.capsules.push_back({index, from, *tip, radius});
  } else if (link.mass > 0 && !item.describing()) {
    item.refuse("mass", fmt::format("{} kg of a link without a tip; permitted is 0 there", link.mass));
  }
  parts.links.push_back(link);
}

std::vector<Obstacle> figure_obstacles(const std::vector<RigidBodySpec>& bodies) {
  std::vector<Obstacle> result;
  for (const RigidBodySpec& body : bodies) {
    if (body.mass > 0) continue;
    if (const auto obstacle = obstacle_of(body)) result.push_back(*obstacle);
  }
  return result;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

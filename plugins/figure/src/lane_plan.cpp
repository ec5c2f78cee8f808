#include "lane_plan.h"

#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kSmall = 1e-15;  // of a unit vector: rounding
double snapped(double x) {
  for (const double whole : {-1.0, 0.0, 1.0}) {
    if (std::abs(x - whole) < kSmall) return whole;
  }
  return x;
}

M3<double> about_z(double cosine, double sine) { return {{cosine, sine, 0}, {-sine, cosine, 0}, {0, 0, 1}}; }
M3<double> transposed(const M3<double>& m) {
  return {{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}};
}

LaneTurn kind_of(const M3<double>& turn) {
  if (turn.x.x != 1) return LaneTurn::kGeneral;
  if (turn.y.y == 1) return LaneTurn::kNone;
  if (turn.y.y == -1) return LaneTurn::kHalf;
  return turn.y.z == 1 ? LaneTurn::kQuarter : LaneTurn::kAboutX;
}

}  // namespace

StraightBodies straighten(const Tree& tree) {
  StraightBodies result;
  result.children.resize(tree.bodies.size());
  result.twists.resize(tree.bodies.size());
  std::vector<LaneBody<double>>& bodies = result.bodies;
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const TreeBody& body = tree.bodies[i];
    bodies.push_back(
        {body.turn, 0, body.origin, body.mass, body.first_moment, body.inertia, body.armature, body.damping});
    if (body.parent >= 0)
      result.children[static_cast<std::size_t>(body.parent)].push_back(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {  // parents first
    LaneBody<double>& body = bodies[i];
    if (tree.bodies[i].joint != JointKind::kHinge) continue;
    // Of its own axes x lies where the parent's does, if z allows it.
    if (std::abs(body.turn.z.x) < kSmall) {
      const double y = snapped(body.turn.z.y), z = snapped(body.turn.z.z);
      const M3<double> straight{{1, 0, 0}, {0, z, -y}, {0, y, z}};
      const V3<double> x = transposed(straight) * body.turn.x;  // in the plane of the hinge
      body.offset = std::atan2(x.y, x.x);
      body.turn = straight;
    }
    // The first hinge on it whose axis is not along its own says how it is turned.
    double cosine = 1, sine = 0;
    for (const int child : result.children[i]) {
      const V3<double> z = bodies[static_cast<std::size_t>(child)].turn.z;
      const double size = std::hypot(z.x, z.y);
      if (tree.bodies[static_cast<std::size_t>(child)].joint != JointKind::kHinge || size < kSmall) continue;
      cosine = -z.y / size;  // so that z turns to -y: a quarter turn, not three
      sine = z.x / size;
      break;
    }
    if (sine == 0 && cosine == 1) continue;
    body.offset += std::atan2(sine, cosine);
    result.twists[i] = {cosine, sine};
    const M3<double> back = transposed(about_z(cosine, sine));
    body.first_moment = back * body.first_moment;
    body.inertia = rotated(back, body.inertia);
    for (const int child : result.children[i]) {
      LaneBody<double>& c = bodies[static_cast<std::size_t>(child)];
      c.turn = back * c.turn;
      c.origin = back * c.origin;
    }
  }
  return result;
}

LaneStep lane_step(const Tree& tree, const StraightBodies& straight, int index) {
  const auto i = static_cast<std::size_t>(index);
  const TreeBody& body = tree.bodies[i];
  LaneStep step;
  step.joint = body.joint;
  step.turn = kind_of(straight.bodies[i].turn);
  step.armed = body.armed;
  step.massive = !body.massless;
  step.whirls = step.massive;
  for (const int child : straight.children[i])
    step.whirls |= tree.bodies[static_cast<std::size_t>(child)].armed;
  step.leaf = straight.children[i].empty();
  step.damped = body.damping > 0;
  step.root = body.parent < 0;
  step.q = body.q;
  step.v = body.v;
  step.ball = body.ball;
  return step;
}

LanePlan plan_lanes(const Tree& tree) {
  LanePlan plan;
  const StraightBodies straight = straighten(tree);
  // By depth, so that what follows each other is independent and a processor can overlap it.
  std::vector<int> order;
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    if (tree.bodies[i].parent < 0) order.push_back(static_cast<int>(i));
  }
  for (std::size_t n = 0; n < order.size(); ++n) {
    const std::vector<int>& next = straight.children[static_cast<std::size_t>(order[n])];
    order.insert(order.end(), next.begin(), next.end());
  }
  std::vector<int> slot(tree.bodies.size(), 0), free;
  for (const int visited : order) {
    const auto i = static_cast<std::size_t>(visited);
    const int parent = tree.bodies[i].parent;
    LaneStep step = lane_step(tree, straight, visited);
    step.over = parent >= 0 && straight.children[static_cast<std::size_t>(parent)].back() == visited;
    if (parent >= 0) step.parent_slot = slot[static_cast<std::size_t>(parent)];
    if (step.over) {
      slot[i] = step.parent_slot;
    } else if (free.empty()) {
      slot[i] = plan.slots++;
    } else {
      slot[i] = free.back();
      free.pop_back();
    }
    step.slot = slot[i];
    if (step.leaf) free.push_back(slot[i]);
    plan.steps.push_back(step);
    plan.bodies.push_back(straight.bodies[i]);
  }
  return plan;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

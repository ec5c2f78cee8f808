#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "softpoint/figure/swing_twist.h"
#include "support.h"

namespace softpoint::figure {

inline Link ball_link(const char* link_name, int parent, double length) {
  Link link;
  link.name = link_name;
  link.parent = parent;
  link.joint = JointKind::kBall;
  set_cylinder(link, 1.5, 0.05, length);
  link.center_of_mass = -link.center_of_mass;
  return link;
}

// A chain of balls with elliptic cones and twists, hanging or free.
inline FigureModel cone_chain(int links, bool floating) {
  std::vector<Link> result;
  if (floating) {
    result.push_back(ball_link("root", -1, 0.4));
    result[0].joint = JointKind::kFree;
  }
  for (int i = 0; i < links; ++i) {
    Link link = ball_link(("b" + std::to_string(i)).c_str(), static_cast<int>(result.size()) - 1, 0.4);
    if (!result.empty()) link.origin = {0, 0, -0.4};
    link.swing_about = 0.5 + 0.2 * i;
    link.swing_across = 1.3 - 0.25 * i;
    link.swing_axis = {1, 0.3 * i, 0.1};
    link.lower = -0.4;
    link.upper = 0.7;
    result.push_back(link);
  }
  return FigureModel(result);
}

inline FigureState random_inside(const FigureModel& model, RandomFigures& random, double speed) {
  FigureState state = rest_state(model);
  for (int i = 0; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    if (link.joint != JointKind::kBall) continue;
    const double angle = 10 * random.vector().x(), reach = std::abs(std::tanh(random.vector().x()));
    const Vec3 other = link.axis.cross(link.swing_axis);
    SwingTwist turn;
    turn.swing = reach * (std::cos(angle) * link.swing_about * link.swing_axis +
                          std::sin(angle) * link.swing_across * other);
    turn.twist = link.lower + (0.5 + 0.5 * std::tanh(random.vector().x())) * (link.upper - link.lower);
    set_swing_twist(link, turn, state.q.data() + model.position_offset(i));
  }
  for (double& v : state.qd) v = speed * random.vector().x();
  return state;
}

}  // namespace softpoint::figure

#include "link_chain.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::figure {

LinkChain::LinkChain(const FigureModel& model, int link) : model_(&model) {
  for (int i = link; i >= 0; i = model.links()[static_cast<std::size_t>(i)].parent) links_.push_back(i);
  std::reverse(links_.begin(), links_.end());
}

PointMotion LinkChain::evaluate(const Vec3& point, const double* q, const double* qd,
                                const double* qdd) const {
  PointMotion m;
  const auto shift = [&](const Vec3& arm) {  // to another point of the same body
    m.position += arm;
    m.velocity += m.spin.cross(arm);
    m.acceleration += m.spin_rate.cross(arm) + m.spin.cross(m.spin.cross(arm));
  };
  const auto three = [](const double* from, int at) {
    return from == nullptr ? Vec3(Vec3::Zero()) : Vec3(from[at], from[at + 1], from[at + 2]);
  };
  const auto turn = [&](const Vec3& rate, const Vec3& gain) {  // world axes
    m.spin_rate += gain + m.spin.cross(rate);
    m.spin += rate;
  };
  for (const int i : links_) {
    const Link& link = model_->links()[static_cast<std::size_t>(i)];
    const int at = model_->position_offset(i), v = model_->velocity_offset(i);
    shift(m.axes * link.origin);
    m.axes = m.axes * link.orientation;
    switch (link.joint) {
      case JointKind::kHinge: {
        const Vec3 axis = m.axes * link.axis;
        turn(axis * (qd == nullptr ? 0 : qd[v]), axis * (qdd == nullptr ? 0 : qdd[v]));
        m.axes = m.axes * Eigen::AngleAxisd(q[at], link.axis).toRotationMatrix();
        break;
      }
      case JointKind::kPrismatic: {
        const Vec3 axis = m.axes * link.axis;
        const Vec3 rate = axis * (qd == nullptr ? 0 : qd[v]);
        shift(axis * q[at]);
        m.acceleration += 2 * m.spin.cross(rate) + axis * (qdd == nullptr ? 0 : qdd[v]);
        m.velocity += rate;
        break;
      }
      case JointKind::kBall: {
        m.axes = m.axes * Eigen::Quaterniond(q[at], q[at + 1], q[at + 2], q[at + 3]).toRotationMatrix();
        turn(m.axes * three(qd, v), m.axes * three(qdd, v));
        break;
      }
      case JointKind::kFree: {
        m.position += three(q, at);
        m.velocity += three(qd, v + 3);
        m.acceleration += three(qdd, v + 3);
        m.axes = Eigen::Quaterniond(q[at + 3], q[at + 4], q[at + 5], q[at + 6]).toRotationMatrix();
        turn(three(qd, v), three(qdd, v));
        break;
      }
      case JointKind::kFixed:
        break;
    }
  }
  shift(m.axes * point);
  return m;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

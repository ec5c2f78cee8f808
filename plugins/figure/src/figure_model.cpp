#include "softpoint/figure/figure_model.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kMaxLinkMass = 1e9, kMaxLinkInertia = 1e15;

std::string field_of(const Link& link, int index, const char* field) {
  return "link " + std::to_string(index) + " '" + link.name + "' " + field;
}

void check_inertia(const Link& link, int index) {
  const std::string field = field_of(link, index, "inertia");
  for (int k = 0; k < 9; ++k) check_range(field, link.inertia.data()[k], -kMaxLinkInertia, kMaxLinkInertia);
  const double size = link.inertia.cwiseAbs().maxCoeff();
  const double slack = 1e-6 * size;
  if ((link.inertia - link.inertia.transpose()).cwiseAbs().maxCoeff() > slack) {
    throw Error(field + " is not symmetric; permitted is a symmetric matrix");
  }
  const Vec3 moments =
      Eigen::SelfAdjointEigenSolver<Mat3>(link.inertia, Eigen::EigenvaluesOnly).eigenvalues();
  if (moments[0] < -slack) {
    throw Error(field + " has the principal moment " + to_text(moments[0]) +
                "; permitted are moments >= 0 kg m2");
  }
  if (moments[2] > moments[0] + moments[1] + slack) {
    throw Error(field + " has the principal moments " + to_text(moments) +
                "; permitted are those of a body: none above the sum of the two others");
  }
  if (link.mass == 0 && size > 0) {
    throw Error(field + " is not zero for a link of mass 0; permitted there is a zero matrix");
  }
}

void check_link(const Link& link, int index) {
  if (link.parent < -1 || link.parent >= index) {
    throw Error(field_of(link, index, "parent") + " = " + std::to_string(link.parent) +
                "; permitted is -1 (the world) or the index of an earlier link, below " +
                std::to_string(index));
  }
  if (link.joint == JointKind::kFree && link.parent != -1) {
    throw Error(field_of(link, index, "joint") +
                " is free; permitted only for links whose parent is the world");
  }
  check_range(field_of(link, index, "mass"), link.mass, 0, kMaxLinkMass);
  check_range(field_of(link, index, "origin"), link.origin, -kMaxPosition, kMaxPosition);
  check_range(field_of(link, index, "center_of_mass"), link.center_of_mass, -kMaxPosition, kMaxPosition);
  check_finite(field_of(link, index, "axis"), link.axis);
  if ((link.joint == JointKind::kHinge || link.joint == JointKind::kPrismatic) &&
      !(link.axis.norm() > 1e-9 && link.axis.norm() < 1e9)) {
    throw Error(field_of(link, index, "axis") + " = " + to_text(link.axis) +
                "; permitted is a direction with a length from 1e-09 to 1e+09");
  }
  const Mat3 gram = link.orientation.transpose() * link.orientation;
  if (!((gram - Mat3::Identity()).cwiseAbs().maxCoeff() < 1e-6) || !(link.orientation.determinant() > 0)) {
    throw Error(field_of(link, index, "orientation") + " is no rotation; permitted is a rotation matrix");
  }
  check_range(field_of(link, index, "armature"), link.armature, 0, kMaxLinkInertia);
  check_range(field_of(link, index, "damping"), link.damping, 0, 1e15);
  check_range(field_of(link, index, "friction"), link.friction, 0, 1e15);
  if (link.friction > 0 && link.joint != JointKind::kHinge && link.joint != JointKind::kPrismatic) {
    throw Error(field_of(link, index, "friction") + " = " + to_text(link.friction) + " of a " +
                name(link.joint) + " joint; permitted is 0 but for hinge and prismatic joints");
  }
  check_range(field_of(link, index, "lower"), link.lower, -1e9, 1e9);
  check_range(field_of(link, index, "upper"), link.upper, link.lower, 1e9);
  check_inertia(link, index);
}

// The cone and the twist of a ball; its axes become a frame.
void check_ball(Link& link, int index) {
  const bool free = link.swing_about == 1e9 && link.swing_across == 1e9;
  if (link.joint != JointKind::kBall) {
    if (free) return;
    throw Error(field_of(link, index, "swing_about") + " of a " + name(link.joint) +
                " joint; permitted for ball joints only");
  }
  if (free) {
    if (link.lower == -1e9 && link.upper == 1e9) {
      if (!(link.axis.norm() > 1e-9 && link.axis.norm() < 1e9)) link.axis = Vec3::UnitZ();
      link.axis.normalize();
      link.swing_axis = link.axis.unitOrthogonal();
      return;
    }
    throw Error(
        field_of(link, index, "lower") + " = " + to_text(link.lower) +
        " of a ball whose swing is free; permitted are -1e+09 to 1e+09, or a cone: a swing of pi has no "
        "twist");
  }
  check_range(field_of(link, index, "swing_about"), link.swing_about, kLeastSwing, kMostSwing);
  check_range(field_of(link, index, "swing_across"), link.swing_across, kLeastSwing, kMostSwing);
  if (link.lower != -1e9 || link.upper != 1e9) {
    check_range(field_of(link, index, "lower"), link.lower, -kMostTwist, kMostTwist);
    check_range(field_of(link, index, "upper"), link.upper, link.lower, kMostTwist);
  }
  check_finite(field_of(link, index, "swing_axis"), link.swing_axis);
  if (!(link.axis.norm() > 1e-9 && link.axis.norm() < 1e9)) {
    throw Error(field_of(link, index, "axis") + " = " + to_text(link.axis) +
                "; permitted is a direction with a length from 1e-09 to 1e+09");
  }
  link.axis.normalize();
  if (link.swing_axis == Vec3::Zero()) {
    int least = 0;
    link.axis.cwiseAbs().minCoeff(&least);
    link.swing_axis = Vec3::Unit(least);
  }
  const Vec3 across = link.swing_axis - link.swing_axis.dot(link.axis) * link.axis;
  if (!(across.norm() > 1e-3 * link.swing_axis.norm()) || !(link.swing_axis.norm() > 1e-9)) {
    throw Error(field_of(link, index, "swing_axis") + " = " + to_text(link.swing_axis) +
                "; permitted is a direction that is not that of axis");
  }
  link.swing_axis = across.normalized();
}

// A joint that moves nothing has no acceleration of its own.
void check_weight(const std::vector<Link>& links) {
  std::vector<double> carried(links.size());
  for (int i = static_cast<int>(links.size()) - 1; i >= 0; --i) {
    const Link& link = links[static_cast<std::size_t>(i)];
    double& own = carried[static_cast<std::size_t>(i)];
    own += link.mass;
    if (link.joint != JointKind::kFixed && own + link.armature == 0) {
      throw Error(field_of(link, i, "mass") +
                  " = 0 and nothing heavy hangs on it; permitted is a mass > 0 on the " +
                  "link or on one of its children");
    }
    if (link.parent >= 0) carried[static_cast<std::size_t>(link.parent)] += own;
  }
}

}  // namespace

const char* name(JointKind kind) {
  switch (kind) {
    case JointKind::kFixed:
      return "fixed";
    case JointKind::kHinge:
      return "hinge";
    case JointKind::kPrismatic:
      return "prismatic";
    case JointKind::kBall:
      return "ball";
    case JointKind::kFree:
      break;
  }
  return "free";
}

int position_count(JointKind kind) {
  constexpr int kCounts[] = {0, 1, 1, 4, 7};
  return kCounts[static_cast<int>(kind)];
}

int velocity_count(JointKind kind) {
  constexpr int kCounts[] = {0, 1, 1, 3, 6};
  return kCounts[static_cast<int>(kind)];
}

void set_cylinder(Link& link, double mass, double radius, double length) {
  check_range("mass", mass, 0, kMaxLinkMass);
  check_range("radius", radius, 0, kMaxPosition);
  check_range("length", length, 0, kMaxPosition);
  const double across = mass * (3 * radius * radius + length * length) / 12;
  link.mass = mass;
  link.center_of_mass = {0, 0, length / 2};
  link.inertia = Vec3(across, across, mass * radius * radius / 2).asDiagonal();
}

FigureModel::FigureModel(std::vector<Link> links) : links_(std::move(links)) {
  if (links_.empty()) throw Error("links is empty; permitted is at least one link");
  for (int i = 0; i < link_count(); ++i) {
    Link& link = links_[static_cast<std::size_t>(i)];
    check_link(link, i);
    check_ball(link, i);
    if (link.joint == JointKind::kHinge || link.joint == JointKind::kPrismatic) link.axis.normalize();
    position_offsets_.push_back(position_count_);
    velocity_offsets_.push_back(velocity_count_);
    position_count_ += figure::position_count(link.joint);
    velocity_count_ += figure::velocity_count(link.joint);
  }
  check_weight(links_);
}

int FigureModel::find(const std::string& name) const {
  for (int i = 0; i < link_count(); ++i) {
    if (links_[static_cast<std::size_t>(i)].name == name) return i;
  }
  return -1;
}

const std::string& FigureModel::joint_name(int link) const {
  check_index("link", link, link_count());
  const Link& of = links_[static_cast<std::size_t>(link)];
  return of.joint_name.empty() ? of.name : of.joint_name;
}

double FigureModel::total_mass() const {
  double sum = 0;
  for (const Link& link : links_) sum += link.mass;
  return sum;
}

FigureState rest_state(const FigureModel& model) {
  FigureState state;
  state.q.assign(static_cast<std::size_t>(model.position_count()), 0.0);
  state.qd.assign(static_cast<std::size_t>(model.velocity_count()), 0.0);
  for (int i = 0; i < model.link_count(); ++i) {
    const JointKind kind = model.links()[static_cast<std::size_t>(i)].joint;
    const auto offset = static_cast<std::size_t>(model.position_offset(i));
    if (kind == JointKind::kBall) state.q[offset] = 1;
    if (kind == JointKind::kFree) state.q[offset + 3] = 1;
  }
  return state;
}

void check_state(const FigureModel& model, FigureState& state) {
  const auto check_size = [](const char* field, std::size_t size, int wanted) {
    if (size != static_cast<std::size_t>(wanted)) {
      throw Error(std::string(field) + " has " + std::to_string(size) + " numbers; permitted are " +
                  std::to_string(wanted) + " for this figure");
    }
  };
  check_size("q", state.q.size(), model.position_count());
  check_size("qd", state.qd.size(), model.velocity_count());
  // Texts are made for what is refused alone, and nothing is changed before all is known to be good: states
  // are set within steps too.
  const auto check = [&](const Link& link, int i, const char* field, double value) {
    if (!(std::abs(value) <= 1e9)) check_range(field_of(link, i, field), value, -1e9, 1e9);
  };
  const auto turn_of_link = [&](int i) -> double* {
    const JointKind kind = model.links()[static_cast<std::size_t>(i)].joint;
    if (kind != JointKind::kBall && kind != JointKind::kFree) return nullptr;
    return state.q.data() + model.position_offset(i) + (kind == JointKind::kFree ? 3 : 0);
  };
  const auto length_of = [](const double* turn) {
    return std::hypot(std::hypot(turn[0], turn[1]), std::hypot(turn[2], turn[3]));
  };
  for (int i = 0; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    const double* q = state.q.data() + model.position_offset(i);
    const double* qd = state.qd.data() + model.velocity_offset(i);
    for (int k = 0; k < figure::position_count(link.joint); ++k) check(link, i, "q", q[k]);
    for (int k = 0; k < figure::velocity_count(link.joint); ++k) check(link, i, "qd", qd[k]);
    const double* turn = turn_of_link(i);
    if (turn == nullptr || length_of(turn) > 1e-6) continue;
    throw Error(field_of(link, i, "q") + " has a quaternion of length " + to_text(length_of(turn)) +
                "; permitted is a length above 1e-06");
  }
  for (int i = 0; i < model.link_count(); ++i) {
    double* turn = turn_of_link(i);
    if (turn == nullptr) continue;
    const double length = length_of(turn);
    for (int k = 0; k < 4; ++k) turn[k] /= length;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

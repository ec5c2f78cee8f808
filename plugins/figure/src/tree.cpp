#include "tree.h"

#include <Eigen/Geometry>

#include "lane_convert.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

// A body while links are gathered in it: frame of its joint's own link, before its axes are turned.
struct Gathered {
  double mass = 0;
  Vec3 first_moment = Vec3::Zero();  // in body axes
  Mat3 inertia = Mat3::Zero();       // about the joint, body axes
};

// Rotation whose third column is `axis`; the identity where that is z already.
Mat3 axes_with_z(const Vec3& axis) {
  if ((axis - Vec3::UnitZ()).norm() < 1e-15) return Mat3::Identity();
  int smallest = 0;
  axis.cwiseAbs().minCoeff(&smallest);
  Mat3 axes;
  axes.col(2) = axis;
  axes.col(0) = Vec3::Unit(smallest).cross(axis).normalized();
  axes.col(1) = axis.cross(axes.col(0));
  return axes;
}

void gather(const Link& link, const Mat3& turn, const Vec3& origin, Gathered& body) {
  const Vec3 c = origin + turn * link.center_of_mass;
  body.mass += link.mass;
  body.first_moment += link.mass * c;
  body.inertia += turn * link.inertia * turn.transpose() +
                  link.mass * (c.squaredNorm() * Mat3::Identity() - c * c.transpose());
}

}  // namespace

Tree build_tree(const FigureModel& model) {
  Tree tree;
  std::vector<Gathered> gathered;
  for (int i = 0; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    LinkPlace parent{-1, lanes(Mat3(Mat3::Identity())), lanes(Vec3(Vec3::Zero()))};
    if (link.parent >= 0) parent = tree.places[static_cast<std::size_t>(link.parent)];
    // The joint in the axes of the body that carries the parent.
    const Vec3 origin = matrix(parent.turn) * link.origin + vector(parent.origin);
    const Mat3 orientation = matrix(parent.turn) * link.orientation;
    if (link.joint == JointKind::kFixed) {
      if (parent.body >= 0) {
        gather(link, orientation, origin, gathered[static_cast<std::size_t>(parent.body)]);
      }
      tree.places.push_back({parent.body, lanes(orientation), lanes(origin)});
      continue;
    }
    const bool has_axis = link.joint == JointKind::kHinge || link.joint == JointKind::kPrismatic;
    const Mat3 turned =
        has_axis ? axes_with_z(link.axis) : Mat3(Mat3::Identity());  // body axes in the link's
    TreeBody body;
    body.parent = parent.body;
    body.joint = link.joint;
    body.q = model.position_offset(i);
    body.v = model.velocity_offset(i);
    body.dofs = velocity_count(link.joint);
    body.ball = link.joint == JointKind::kBall ? tree.balls++ : 0;
    body.turn = lanes(Mat3(orientation * turned));
    body.origin = lanes(origin);
    body.armed = link.joint == JointKind::kPrismatic || link.joint == JointKind::kFree || !origin.isZero(0);
    if (link.joint != JointKind::kFree) {  // nothing rubs there
      body.armature = link.armature;
      body.damping = link.damping;
    }
    tree.bodies.push_back(body);
    gathered.emplace_back();
    const Mat3 place = turned.transpose();
    gather(link, place, Vec3::Zero(), gathered.back());
    tree.places.push_back(
        {static_cast<int>(tree.bodies.size()) - 1, lanes(place), lanes(Vec3(Vec3::Zero()))});
  }
  for (std::size_t i = 0; i < gathered.size(); ++i) {
    TreeBody& body = tree.bodies[i];
    body.massless = gathered[i].mass == 0;
    body.mass = gathered[i].mass;
    body.first_moment = lanes(gathered[i].first_moment);
    const Mat3& a = gathered[i].inertia;
    body.inertia = {a(0, 0), a(0, 1), a(0, 2), a(1, 1), a(1, 2), a(2, 2)};
  }
  return tree;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

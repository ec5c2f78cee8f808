#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "softpoint/core/error.h"
#include "softpoint/figure/bvh.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Solid bodies gathered in one link.
struct BoneMass {
  double mass = 0;
  Vec3 moment = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();  // about the joint

  void add(double m, const Vec3& center, const Mat3& about_center) {
    mass += m;
    moment += m * center;
    inertia += about_center + m * (center.squaredNorm() * Mat3::Identity() - center * center.transpose());
  }
};

void add_bone(BoneMass& to, const Vec3& end, const BvhFigureSettings& settings) {
  const double length = end.norm(), radius = settings.thickness * length;
  if (!(length > 0)) return;
  const double mass = settings.density * std::numbers::pi * radius * radius * length;
  const Vec3 along = end / length;
  const Mat3 axis = along * along.transpose();
  const double across = mass * (3 * radius * radius + length * length) / 12;
  to.add(mass, 0.5 * end, across * (Mat3::Identity() - axis) + 0.5 * mass * radius * radius * axis);
}

Eigen::Quaterniond bvh_turn(BvhChannel channel, double degrees) {
  Vec3 axis = Vec3::Zero();
  axis[static_cast<int>(channel) - 3] = 1;
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * kDegree, axis));
}

bool places(const BvhJoint& joint) {
  for (const BvhChannel channel : joint.channels) {
    if (channel < BvhChannel::kXRotation) return true;
  }
  return false;
}

void check_settings(const BvhClip& clip, const BvhFigureSettings& settings) {
  check_range("bvh scale", settings.scale, 1e-9, 1e9);
  check_range("bvh density", settings.density, 1e-6, 1e6);
  check_range("bvh thickness", settings.thickness, 1e-6, 10);
  if (clip.joints.empty()) throw Error("bvh joints: none; permitted is a root at least");
}

}  // namespace

FigureModel bvh_figure(const BvhClip& clip, const BvhFigureSettings& settings) {
  check_settings(clip, settings);
  std::vector<Link> links;
  std::vector<BoneMass> masses(clip.joints.size());
  std::vector<double> thickest(clip.joints.size(), 0.0);  // of the bones that begin or end at a joint
  const auto bone = [&](std::size_t joint, const Vec3& end) {
    add_bone(masses[joint], settings.scale * end, settings);
    thickest[joint] = std::max(thickest[joint], settings.scale * settings.thickness * end.norm());
  };
  for (std::size_t i = 0; i < clip.joints.size(); ++i) {
    const BvhJoint& joint = clip.joints[i];
    if (joint.parent >= 0) bone(static_cast<std::size_t>(joint.parent), joint.offset);
    for (const Vec3& end : joint.end_sites) bone(i, end);
  }
  // Joints in one place are as thick as each other: light ones between heavy ones cost digits.
  for (std::size_t i = clip.joints.size(); i-- > 1;) {
    const BvhJoint& joint = clip.joints[i];
    const auto parent = static_cast<std::size_t>(joint.parent);
    const double own = settings.scale * settings.thickness * joint.offset.norm();
    if (own == 0) thickest[parent] = std::max(thickest[parent], thickest[i]);
    thickest[i] = std::max(thickest[i], own);
  }
  for (std::size_t i = 1; i < clip.joints.size(); ++i) {
    const BvhJoint& joint = clip.joints[i];
    if (joint.offset.norm() == 0)
      thickest[i] = std::max(thickest[i], thickest[static_cast<std::size_t>(joint.parent)]);
  }
  for (std::size_t i = 0; i < clip.joints.size(); ++i) {
    const BvhJoint& joint = clip.joints[i];
    if (masses[i].mass == 0) {
      const double radius = thickest[i] > 0 ? thickest[i] : settings.scale * settings.thickness;
      const double mass = settings.density * 4 / 3 * std::numbers::pi * std::pow(radius, 3);
      masses[i].add(mass, Vec3::Zero(), 0.4 * mass * radius * radius * Mat3::Identity());
    }
    Link link;
    link.name = joint.name;
    link.parent = joint.parent;
    link.joint = joint.parent < 0 ? JointKind::kFree : JointKind::kBall;
    const bool placed = link.joint == JointKind::kFree && places(joint);
    link.origin = placed ? Vec3(Vec3::Zero()) : Vec3(settings.scale * joint.offset);
    link.mass = masses[i].mass;
    link.center_of_mass = masses[i].moment / link.mass;
    const Vec3& c = link.center_of_mass;
    link.inertia = masses[i].inertia - link.mass * (c.squaredNorm() * Mat3::Identity() - c * c.transpose());
    links.push_back(link);
  }
  return FigureModel(std::move(links));
}

std::vector<double> bvh_positions(const BvhClip& clip, int frame, const BvhFigureSettings& settings) {
  check_settings(clip, settings);
  check_index("bvh frame", frame, clip.frame_count());
  const double* value = clip.values.data() + static_cast<std::ptrdiff_t>(frame) * clip.channel_count();
  std::vector<double> q;
  for (const BvhJoint& joint : clip.joints) {
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    Vec3 place = Vec3::Zero();
    for (const BvhChannel channel : joint.channels) {
      if (channel < BvhChannel::kXRotation) {
        place[static_cast<int>(channel)] = settings.scale * *value++;
      } else {
        turn = turn * bvh_turn(channel, *value++);
      }
    }
    if (joint.parent < 0) q.insert(q.end(), {place.x(), place.y(), place.z()});
    q.insert(q.end(), {turn.w(), turn.x(), turn.y(), turn.z()});
  }
  return q;
}

std::vector<LinkCapsule> bvh_capsules(const BvhClip& clip, const BvhFigureSettings& settings) {
  check_settings(clip, settings);
  std::vector<LinkCapsule> capsules;
  const auto bone = [&](int joint, const Vec3& end) {
    const Vec3 tip = settings.scale * end;
    const double radius = settings.thickness * tip.norm();
    if (radius > 0) capsules.push_back({joint, Vec3::Zero(), tip, radius});
  };
  for (std::size_t i = 0; i < clip.joints.size(); ++i) {
    const BvhJoint& joint = clip.joints[i];
    if (joint.parent >= 0) bone(joint.parent, joint.offset);
    for (const Vec3& end : joint.end_sites) bone(static_cast<int>(i), end);
  }
  return capsules;
}

std::vector<JointTrack> bvh_tracks(const BvhClip& clip, Interpolation interpolation,
                                   const BvhFigureSettings& settings) {
  check_settings(clip, settings);
  if (clip.frame_count() == 0) throw Error("bvh frames: none; permitted is one at least");
  std::vector<JointTrack> tracks(clip.joints.size());
  for (std::size_t i = 0; i < tracks.size(); ++i) tracks[i] = {static_cast<int>(i), interpolation, {}};
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const std::vector<double> q = bvh_positions(clip, frame, settings);
    auto at = q.begin();
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const auto end = at + (clip.joints[i].parent < 0 ? 7 : 4);
      tracks[i].keys.push_back({frame * clip.frame_time, {at, end}, {}});
      at = end;
    }
  }
  return tracks;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

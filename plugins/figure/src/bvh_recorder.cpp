#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "softpoint/core/error.h"
#include "softpoint/figure/bvh.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180;

}  // namespace

BvhRecorder::BvhRecorder(const FigureModel& model, double frame_time) : model_(model) {
  check_range("bvh frame_time", frame_time, 1e-6, 1000);
  clip_.frame_time = frame_time;
  int roots = 0;
  for (const Link& link : model.links()) roots += link.parent < 0;
  has_world_ = roots > 1;
  const std::vector<BvhChannel> turns = {BvhChannel::kZRotation, BvhChannel::kXRotation,
                                         BvhChannel::kYRotation};
  std::vector<BvhChannel> all = {BvhChannel::kXPosition, BvhChannel::kYPosition, BvhChannel::kZPosition};
  all.insert(all.end(), turns.begin(), turns.end());
  if (has_world_) clip_.joints.push_back({"world", -1, Vec3::Zero(), all, {}});
  // The file's order: each joint is followed by all that hangs on it.
  std::vector<std::vector<int>> children(model.links().size() + 1);
  for (int i = 0; i < model.link_count(); ++i) {
    children[static_cast<std::size_t>(model.links()[static_cast<std::size_t>(i)].parent + 1)].push_back(i);
  }
  std::vector<int> waiting(children[0].rbegin(), children[0].rend());
  std::vector<int> joint_of(model.links().size(), -1);
  while (!waiting.empty()) {
    const int i = waiting.back();
    waiting.pop_back();
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    const bool root = link.parent < 0 && !has_world_;
    const bool slides = link.joint == JointKind::kPrismatic || link.joint == JointKind::kFree;
    // No offset where there are positions: readers differ on whether to add the two.
    const bool placed = root || slides;
    const int parent = link.parent >= 0 ? joint_of[static_cast<std::size_t>(link.parent)]
                       : has_world_     ? 0
                                        : -1;
    joint_of[static_cast<std::size_t>(i)] = static_cast<int>(clip_.joints.size());
    order_.push_back(i);
    clip_.joints.push_back(
        {link.name, parent, placed ? Vec3(Vec3::Zero()) : link.origin, placed ? all : turns, {}});
    const std::vector<int>& own = children[static_cast<std::size_t>(i) + 1];
    if (own.empty()) clip_.joints.back().end_sites.push_back(2 * link.center_of_mass);  // readers want one
    waiting.insert(waiting.end(), own.rbegin(), own.rend());
  }
}

int BvhRecorder::joint_of(int link) const {
  check_index("link", link, model_.link_count());
  const auto found = std::find(order_.begin(), order_.end(), link);
  return static_cast<int>(found - order_.begin()) + has_world_;
}

void BvhRecorder::add(const double* q) {
  const std::size_t before = clip_.values.size();
  const auto row = static_cast<std::size_t>(clip_.channel_count());
  if (has_world_) clip_.values.insert(clip_.values.end(), 6, 0.0);
  for (std::size_t j = 0; j < order_.size(); ++j) {
    const int i = order_[j];
    const Link& link = model_.links()[static_cast<std::size_t>(i)];
    const BvhJoint& joint = clip_.joints[j + has_world_];
    const double* own = q + model_.position_offset(i);
    Mat3 turn = Mat3::Identity();
    Vec3 place = link.origin;
    switch (link.joint) {
      case JointKind::kHinge:
        turn = Eigen::AngleAxisd(own[0], link.axis).toRotationMatrix();
        break;
      case JointKind::kPrismatic:
        place += link.orientation * link.axis * own[0];
        break;
      case JointKind::kBall:
        turn = Eigen::Quaterniond(own[0], own[1], own[2], own[3]).toRotationMatrix();
        break;
      case JointKind::kFree:
        turn = Eigen::Quaterniond(own[3], own[4], own[5], own[6]).toRotationMatrix();
        place += Vec3(own[0], own[1], own[2]);
        break;
      case JointKind::kFixed:
        break;
    }
    // The free joint's quaternion turns to the world itself, whatever the link's orientation at q = 0.
    const Mat3 r = link.joint == JointKind::kFree ? turn : Mat3(link.orientation * turn);
    if (joint.channels.size() == 6)
      clip_.values.insert(clip_.values.end(), {place.x(), place.y(), place.z()});
    // r = Rz(a) Rx(b) Ry(c)
    const double cosine = std::hypot(r(0, 1), r(1, 1));
    double a = 0, b = std::atan2(r(2, 1), cosine), c = 0;
    if (cosine > 1e-12) {
      a = std::atan2(-r(0, 1), r(1, 1));
      c = std::atan2(-r(2, 0), r(2, 2));
    } else {
      a = std::atan2(r(1, 0), r(0, 0));
    }
    double angles[3] = {a, b, c};
    if (before >= row) {  // of the two that turn alike the one nearer to the frame before, whole turns added
      const double* last = clip_.values.data() + (clip_.values.size() - row);
      double other[3] = {a + std::numbers::pi, std::numbers::pi - b, c + std::numbers::pi}, far[2] = {0, 0};
      for (double(*choice)[3] : {&angles, &other}) {
        for (int k = 0; k < 3; ++k) {
          const double wanted = last[k] * kRadiansPerDegree;
          (*choice)[k] += 2 * std::numbers::pi * std::round((wanted - (*choice)[k]) / (2 * std::numbers::pi));
          far[choice == &other] += std::abs((*choice)[k] - wanted);
        }
      }
      if (far[1] < far[0]) std::copy(other, other + 3, angles);
    }
    for (const double angle : angles) clip_.values.push_back(angle / kRadiansPerDegree);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

// What the modes of joints need once for the holders they have.
#include "joint_modes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

using Modes = Eigen::Matrix<double, Eigen::Dynamic, 6>;

// Translations, and rotations about `pivot`, of points given axis-major.
Modes rigid_modes(const Eigen::Ref<const Eigen::VectorXd>& points, const Vec3& pivot) {
  const Eigen::Index n = points.size() / 3;
  Modes modes = Modes::Zero(3 * n, 6);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 arm = Vec3(points[i], points[n + i], points[2 * n + i]) - pivot;
    for (Eigen::Index a = 0; a < 3; ++a) {
      modes(a * n + i, a) = 1.0;
      const Vec3 turned = Vec3::Unit(a).cross(arm);
      for (Eigen::Index b = 0; b < 3; ++b) modes(b * n + i, 3 + a) = turned[b];
    }
  }
  return modes;
}

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& m, double least) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(m);
  Eigen::VectorXd values = eigen.eigenvalues();
  const double limit = least * values.cwiseAbs().maxCoeff();
  for (double& v : values) v = v > limit ? 1.0 / v : 0.0;
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

JointModes::JointModes(const PartGroup& group, const Kernels& kernels, bool single)
    : group_(group),
      kernels_(kernels),
      single_(single),
      nodes_(group.joints().size()),
      graph_(group, false),
      links_(static_cast<std::size_t>(graph_.links)) {
  for (const auto& packed : group.models()) {
    tangents_.emplace_back(*packed, single);
    const auto count = std::count_if(
        group.segments().begin(), group.segments().end(),
        [&](const auto& segment) { return segment.model == static_cast<int>(tangents_.size()) - 1; });
    segments_of_.push_back(count);
    tangents_.back().reserve(count);
    const std::size_t interfaces = packed->model->interfaces.size();
    tangent_.resize(std::max(tangent_.size(), interfaces + 1));
    tangent_[interfaces].resize(6 * static_cast<Eigen::Index>(interfaces),
                                6 * static_cast<Eigen::Index>(interfaces));
  }
}

void JointModes::prepare(const std::vector<char>& held, const Eigen::VectorXd& inertia,
                         const BlockRows& rows) {
  warpings_.clear();
  kinds_.clear();
  std::size_t scratch = 0;
  for (std::size_t j = 0; j < nodes_.size(); ++j) {
    const PartGroup::Joint& joint = group_.joints()[j];
    Node& node = nodes_[j];
    const Eigen::Index n = joint.count;
    const auto points = group_.rest().segment(3 * joint.first, 3 * n);
    Vec3 mean = Vec3::Zero();
    int pins = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      mean += Vec3(points[i], points[n + i], points[2 * n + i]) / static_cast<double>(n);
      pins += held[static_cast<std::size_t>(joint.first + i)] != 0 ? 1 : 0;
    }
    node.held = pins == n;
    node.pinned = pins > 0 && pins < n;
    // Held points stay while the others move.
    node.modes = rigid_modes(points, mean);
    for (Eigen::Index i = 0; i < 3 * n; ++i) {
      if (held[static_cast<std::size_t>(joint.first + i % n)] != 0) node.modes.row(i).setZero();
    }
    Eigen::VectorXd mass(3 * n);
    for (Eigen::Index i = 0; i < 3 * n; ++i) mass[i] = inertia[joint.first + i % n];
    node.rest_inertia = node.modes.transpose() * mass.asDiagonal() * node.modes;
    // What is left of the joint's own stiffness when it may not move as a rigid body.
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < 3 * n; ++i) {
      if (held[static_cast<std::size_t>(joint.first + i % n)] == 0) free.push_back(i);
    }
    Eigen::MatrixXd warping = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    if (!free.empty()) {
      const Eigen::MatrixXd z = node.modes(free, Eigen::all);
      const auto count = static_cast<Eigen::Index>(free.size());
      const Eigen::MatrixXd out = Eigen::MatrixXd::Identity(count, count) -
                                  z * pseudo_inverse(z.transpose() * z, 1e-12) * z.transpose();
      warping(free, free) = pseudo_inverse(out * rows[j].at(j)(free, free) * out, 1e-9);
    }
    const auto same = std::find_if(warpings_.begin(), warpings_.end(), [&](const Warping& w) {
      return w.matrix.rows() == warping.rows() &&
             (w.matrix - warping).cwiseAbs().maxCoeff() <= 1e-12 * w.matrix.cwiseAbs().maxCoeff();
    });
    node.warping = static_cast<int>(same - warpings_.begin());
    if (same == warpings_.end())
      warpings_.push_back({warping, Product(kernels_, warping, single_), {}, {}, {}});
    Warping& kept = warpings_[static_cast<std::size_t>(node.warping)];
    node.column = static_cast<int>(kept.joints.size());
    kept.joints.push_back(static_cast<int>(j));
  }
  for (Warping& w : warpings_) {
    const auto n = static_cast<Eigen::Index>(w.joints.size());
    w.in.resize(static_cast<std::size_t>(n * w.product.depth()));
    w.out.resize(static_cast<std::size_t>(n * w.product.padded_rows()));
    scratch = std::max(scratch, w.product.scratch(n));
  }
  scratch_.resize(scratch);
  // Stiffness of each segment against these motions, in its own frame.
  segment_stiffness_.clear();
  for (const PartGroup::Segment& segment : group_.segments()) {
    const auto m = static_cast<std::size_t>(segment.model);
    const SegmentModel& model = *group_.models()[m]->model;
    const Eigen::Index count = model.joint_points();
    std::vector<char> pins;
    for (const Eigen::Index at : segment.at) pins.push_back(held[group_.index_of(at)]);
    const auto same = std::find_if(kinds_.begin(), kinds_.end(),
                                   [&](const Kind& k) { return k.model == segment.model && k.pins == pins; });
    segment_stiffness_.push_back(static_cast<int>(same - kinds_.begin()));
    if (same != kinds_.end()) continue;
    Eigen::MatrixXd z = tangents_[m].modes();
    for (Eigen::Index i = 0; i < count; ++i) {
      if (pins[static_cast<std::size_t>(i)] == 0) continue;
      for (Eigen::Index a = 0; a < 3; ++a) z.row(a * count + i).setZero();
    }
    const Eigen::Map<const Eigen::MatrixXd> k(model.stiffness.data(), 3 * count, 3 * count);
    kinds_.push_back({segment.model, std::move(pins), z.transpose() * k * z});
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

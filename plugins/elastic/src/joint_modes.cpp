#include "joint_modes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <set>

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

Eigen::Matrix<double, 6, 6> turned(const Mat3& r, const Eigen::Matrix<double, 6, 6>& m) {
  Eigen::Matrix<double, 6, 6> out;
  for (int i = 0; i < 6; i += 3) {
    for (int j = 0; j < 6; j += 3) {
      out.block<3, 3>(i, j) = r * m.block<3, 3>(i, j).eval() * r.transpose();
    }
  }
  return out;
}

}  // namespace

JointModes::JointModes(const PartGroup& group, const Kernels& kernels, bool single)
    : group_(group), kernels_(kernels), single_(single), nodes_(group.joints().size()) {
  // Rigid motions of each model's interfaces about the mean of their points.
  for (const auto& packed : group.models()) {
    const SegmentModel& model = *packed->model;
    const Eigen::Index count = model.joint_points();
    Eigen::MatrixXd z =
        Eigen::MatrixXd::Zero(3 * count, 6 * static_cast<Eigen::Index>(model.interfaces.size()));
    Eigen::Index first = 0;
    for (std::size_t i = 0; i < model.interfaces.size(); ++i) {
      const auto n = static_cast<Eigen::Index>(model.interfaces[i].size());
      Eigen::VectorXd points(3 * n);
      Vec3 mean = Vec3::Zero();
      for (Eigen::Index k = 0; k < n; ++k) {
        const Vec3 arm = packed->arms.row(first + k);
        mean += arm / static_cast<double>(n);
        for (Eigen::Index a = 0; a < 3; ++a) points[a * n + k] = arm[a];
      }
      const Modes modes = rigid_modes(points, mean);
      for (Eigen::Index a = 0; a < 3; ++a) {
        z.block(a * count + first, 6 * static_cast<Eigen::Index>(i), n, 6) = modes.middleRows(a * n, n);
      }
      first += n;
    }
    model_modes_.push_back(std::move(z));
  }
  // Joints of each segment, interface by interface.
  for (const PartGroup::Segment& segment : group.segments()) {
    segment_joints_.emplace_back();
    const SegmentModel& model = *group.models()[static_cast<std::size_t>(segment.model)]->model;
    std::size_t first = 0;
    for (const auto& interface : model.interfaces) {
      const Eigen::Index at = segment.at[first];
      std::size_t j = 0;
      while (j + 1 < nodes_.size() && 3 * group.joints()[j + 1].first <= at) ++j;
      segment_joints_.back().push_back(static_cast<int>(j));
      first += interface.size();
    }
  }
  // Elimination, fewest neighbours first.
  std::vector<std::set<int>> neighbours(nodes_.size());
  for (const auto& joints : segment_joints_) {
    for (const int a : joints) {
      for (const int b : joints) {
        if (a != b) neighbours[static_cast<std::size_t>(a)].insert(b);
      }
    }
  }
  std::vector<char> done(nodes_.size(), 0);
  for (std::size_t step = 0; step < nodes_.size(); ++step) {
    std::size_t next = nodes_.size();
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (done[i] == 0 && (next == nodes_.size() || neighbours[i].size() < neighbours[next].size())) next = i;
    }
    done[next] = 1;
    order_.push_back(static_cast<int>(next));
    for (const int a : neighbours[next]) {
      nodes_[next].couplings.emplace_back(a, static_cast<int>(links_.size()));
      links_.emplace_back();
      auto& of_a = neighbours[static_cast<std::size_t>(a)];
      of_a.erase(static_cast<int>(next));
      for (const int b : neighbours[next]) {
        if (a != b) of_a.insert(b);
      }
    }
  }
}

int JointModes::link_of(int first, int later) const {
  for (const auto& [joint, link] : nodes_[static_cast<std::size_t>(first)].couplings) {
    if (joint == later) return link;
  }
  return -1;
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
    Eigen::MatrixXd z = model_modes_[m];
    for (Eigen::Index i = 0; i < count; ++i) {
      if (pins[static_cast<std::size_t>(i)] == 0) continue;
      for (Eigen::Index a = 0; a < 3; ++a) z.row(a * count + i).setZero();
    }
    const Eigen::Map<const Eigen::MatrixXd> k(model.stiffness.data(), 3 * count, 3 * count);
    kinds_.push_back({segment.model, std::move(pins), z.transpose() * k * z});
  }
}

void JointModes::factor() {
  for (Link& link : links_) link.stiffness.setZero();
  for (std::size_t j = 0; j < nodes_.size(); ++j) {
    nodes_[j].inverse = turned(group_.joints()[j].turn, nodes_[j].rest_inertia);
  }
  for (std::size_t s = 0; s < segment_joints_.size(); ++s) {
    const PartGroup::Segment& segment = group_.segments()[s];
    const Eigen::MatrixXd& k = kinds_[static_cast<std::size_t>(segment_stiffness_[s])].stiffness;
    const std::vector<int>& joints = segment_joints_[s];
    for (std::size_t a = 0; a < joints.size(); ++a) {
      for (std::size_t b = 0; b < joints.size(); ++b) {
        const int link = a == b ? 0 : link_of(joints[a], joints[b]);
        if (link < 0) continue;
        const Matrix6 block = turned(segment.rotation, k.block<6, 6>(6 * static_cast<Eigen::Index>(a),
                                                                     6 * static_cast<Eigen::Index>(b)));
        (a == b ? nodes_[static_cast<std::size_t>(joints[a])].inverse
                : links_[static_cast<std::size_t>(link)].stiffness) += block;
      }
    }
  }
  // Parts held by points are free to turn about them: no force resists that, and rounding must not be taken
  // for one. A joint that turns about a point is held back by so much of its own stiffness.
  constexpr double kPinned = 1e-3;
  for (Node& node : nodes_) {
    if (node.pinned) node.inverse.diagonal().tail<3>() *= 1.0 + kPinned;
    // Lengths and angles differ in scale: what is loose is judged against the joint's own stiffness, which
    // elimination may leave as rounding of either sign.
    for (int m = 0; m < 6; ++m) {
      const double own = node.inverse(m, m);
      node.scale[m] = own > 0.0 ? 1.0 / std::sqrt(own) : 0.0;
    }
    if (node.held) node.scale.setOnes();
  }
  for (const int j : order_) {
    Node& node = nodes_[static_cast<std::size_t>(j)];
    Matrix6 d = node.inverse;
    if (node.held) d.setIdentity();
    d = 0.5 * (d + d.transpose()).eval();
    const Vector6 scale = node.scale;
    const Matrix6 even = scale.asDiagonal() * d * scale.asDiagonal();
    const Eigen::LLT<Matrix6> llt(even);
    const auto pivots = llt.matrixLLT().diagonal();
    if (llt.info() == Eigen::Success && pivots.minCoeff() > 1e-5) {
      node.inverse = scale.asDiagonal() * llt.solve(Matrix6::Identity()) * scale.asDiagonal();
    } else {
      const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(even);
      Vector6 values = eigen.eigenvalues();
      for (double& v : values) v = v > 1e-10 ? 1.0 / v : 0.0;
      node.inverse = scale.asDiagonal() *
                     (eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose()) *
                     scale.asDiagonal();
    }
    for (const auto& [a, link_a] : node.couplings) {
      Link& la = links_[static_cast<std::size_t>(link_a)];
      la.lower.noalias() = la.stiffness.transpose() * node.inverse;
    }
    for (const auto& [a, link_a] : node.couplings) {
      for (const auto& [b, link_b] : node.couplings) {
        const int target = a == b ? 0 : link_of(a, b);
        if (target < 0) continue;
        Matrix6& to = a == b ? nodes_[static_cast<std::size_t>(a)].inverse
                             : links_[static_cast<std::size_t>(target)].stiffness;
        to.noalias() -= links_[static_cast<std::size_t>(link_a)].lower *
                        links_[static_cast<std::size_t>(link_b)].stiffness;
      }
    }
  }
}

void JointModes::apply(const Eigen::VectorXd& force, Eigen::VectorXd& displacement) {
  for (std::size_t j = 0; j < nodes_.size(); ++j) {
    const PartGroup::Joint& joint = group_.joints()[j];
    Node& node = nodes_[j];
    Warping& w = warpings_[static_cast<std::size_t>(node.warping)];
    double* const local = w.in.data() + node.column * w.product.depth();
    const double* const in = force.data() + 3 * joint.first;
    const Eigen::Index n = joint.count;
    const Mat3 q = joint.turn;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double x = in[i], y = in[n + i], z = in[2 * n + i];
      local[i] = q(0, 0) * x + q(1, 0) * y + q(2, 0) * z;
      local[n + i] = q(0, 1) * x + q(1, 1) * y + q(2, 1) * z;
      local[2 * n + i] = q(0, 2) * x + q(1, 2) * y + q(2, 2) * z;
    }
    const Vector6 c = node.modes.transpose() * Eigen::Map<const Eigen::VectorXd>(local, 3 * n);
    node.value.head<3>() = q * c.head<3>();
    node.value.tail<3>() = q * c.tail<3>();
  }
  for (Warping& w : warpings_) {
    w.product.multiply(w.in.data(), static_cast<Eigen::Index>(w.joints.size()), w.out.data(),
                       scratch_.data());
  }
  const auto value = [&](int j) -> Vector6& { return nodes_[static_cast<std::size_t>(j)].value; };
  for (const int j : order_) {
    for (const auto& [later, link] : nodes_[static_cast<std::size_t>(j)].couplings) {
      value(later).noalias() -= links_[static_cast<std::size_t>(link)].lower * value(j);
    }
  }
  for (auto j = order_.rbegin(); j != order_.rend(); ++j) {
    Node& node = nodes_[static_cast<std::size_t>(*j)];
    node.value = (node.inverse * node.value).eval();
    for (const auto& [later, link] : node.couplings) {
      node.value.noalias() -= links_[static_cast<std::size_t>(link)].lower.transpose() * value(later);
    }
  }
  for (std::size_t j = 0; j < nodes_.size(); ++j) {
    const PartGroup::Joint& joint = group_.joints()[j];
    const Node& node = nodes_[j];
    Warping& w = warpings_[static_cast<std::size_t>(node.warping)];
    Eigen::Map<Eigen::VectorXd> local(w.out.data() + node.column * w.product.padded_rows(), 3 * joint.count);
    const Mat3 q = joint.turn;
    Vector6 rigid;
    rigid << q.transpose() * node.value.head<3>(), q.transpose() * node.value.tail<3>();
    local.noalias() += node.modes * rigid;
    double* const out = displacement.data() + 3 * joint.first;
    const Eigen::Index n = joint.count;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double x = local[i], y = local[n + i], z = local[2 * n + i];
      out[i] = q(0, 0) * x + q(0, 1) * y + q(0, 2) * z;
      out[n + i] = q(1, 0) * x + q(1, 1) * y + q(1, 2) * z;
      out[2 * n + i] = q(2, 0) * x + q(2, 1) * y + q(2, 2) * z;
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

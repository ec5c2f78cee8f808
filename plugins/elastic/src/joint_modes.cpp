#include "joint_modes.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

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

void JointModes::factor() {
  for (Link& link : links_) link.stiffness.setZero();
  for (std::size_t j = 0; j < nodes_.size(); ++j) {
    nodes_[j].inverse = turned(group_.joints()[j].turn, nodes_[j].rest_inertia);
  }
  for (std::size_t m = 0; m < tangents_.size(); ++m) {
    if (segments_of_[m] > 0)
      tangents_[m].prepare(group_.strains(static_cast<int>(m)).data(), segments_of_[m]);
  }
  for (std::size_t s = 0; s < graph_.segment_joints.size(); ++s) {
    const PartGroup::Segment& segment = group_.segments()[s];
    const std::vector<int>& joints = graph_.segment_joints[s];
    Eigen::MatrixXd& k = tangent_[joints.size()];
    k = kinds_[static_cast<std::size_t>(segment_stiffness_[s])].stiffness;
    tangents_[static_cast<std::size_t>(segment.model)].add_geometry(segment.column, k);
    for (std::size_t a = 0; a < joints.size(); ++a) {
      for (std::size_t b = 0; b < joints.size(); ++b) {
        const int link = a == b ? 0 : graph_.link_of(joints[a], joints[b]);
        if (link < 0 || nodes_[static_cast<std::size_t>(joints[a])].held ||
            nodes_[static_cast<std::size_t>(joints[b])].held) {
          continue;
        }
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
      const double own = std::abs(node.inverse(m, m));
      node.scale[m] = own > 0.0 ? 1.0 / std::sqrt(own) : 0.0;
    }
    if (node.held) node.scale.setOnes();
  }
  for (const int j : graph_.order) {
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
      for (double& v : values) v = std::abs(v) > 1e-10 ? 1.0 / std::abs(v) : 0.0;
      node.inverse = scale.asDiagonal() *
                     (eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose()) *
                     scale.asDiagonal();
    }
    for (const auto& [a, link_a] : graph_.couplings[static_cast<std::size_t>(j)]) {
      Link& la = links_[static_cast<std::size_t>(link_a)];
      la.lower.noalias() = la.stiffness.transpose() * node.inverse;
    }
    for (const auto& [a, link_a] : graph_.couplings[static_cast<std::size_t>(j)]) {
      for (const auto& [b, link_b] : graph_.couplings[static_cast<std::size_t>(j)]) {
        const int target = a == b ? 0 : graph_.link_of(a, b);
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
  for (const int j : graph_.order) {
    for (const auto& [later, link] : graph_.couplings[static_cast<std::size_t>(j)]) {
      value(later).noalias() -= links_[static_cast<std::size_t>(link)].lower * value(j);
    }
  }
  for (auto j = graph_.order.rbegin(); j != graph_.order.rend(); ++j) {
    Node& node = nodes_[static_cast<std::size_t>(*j)];
    node.value = (node.inverse * node.value).eval();
    for (const auto& [later, link] : graph_.couplings[static_cast<std::size_t>(*j)]) {
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

#include "joint_factor.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

void JointFactor::reserve(std::vector<double>& scratch) {
  scratch.resize(std::max(scratch.size(), static_cast<std::size_t>(kernels_.scratch)));
  if (!diagonal_.empty()) return;
  const auto& joints = group_.joints();
  links_.resize(static_cast<std::size_t>(graph_.links));
  for (std::size_t j = 0; j < joints.size(); ++j) {
    diagonal_.emplace_back(3 * joints[j].count, 3 * joints[j].count);
    for (const auto& [later, link] : graph_.couplings[j]) {
      links_[static_cast<std::size_t>(link)].resize(3 * joints[static_cast<std::size_t>(later)].count,
                                                    3 * joints[j].count);
    }
  }
}

JointFactor::Block JointFactor::block_of(int a, int b) {
  if (a == b) return {&diagonal_[static_cast<std::size_t>(a)], false};
  int link = graph_.link_of(b, a);
  if (link >= 0) return {&links_[static_cast<std::size_t>(link)], false};
  link = graph_.link_of(a, b);
  return {link >= 0 ? &links_[static_cast<std::size_t>(link)] : nullptr, true};
}

// R K R^T of each segment, to its joints' blocks.
void JointFactor::add_segments() {
  for (std::size_t s = 0; s < group_.segments().size(); ++s) {
    const PartGroup::Segment& segment = group_.segments()[s];
    const SegmentModel& model = *group_.models()[static_cast<std::size_t>(segment.model)]->model;
    const Eigen::Index n = model.joint_points(), all = 3 * n;
    const Mat3& r = segment.rotation;
    half_turned_.resize(all, all);
    turned_.resize(all, all);
    const Eigen::Map<const Eigen::MatrixXd> k(model.stiffness.data(), all, all);
    for (Eigen::Index a = 0; a < 3; ++a) {
      half_turned_.middleRows(a * n, n) =
          r(a, 0) * k.topRows(n) + r(a, 1) * k.middleRows(n, n) + r(a, 2) * k.bottomRows(n);
    }
    for (Eigen::Index a = 0; a < 3; ++a) {
      turned_.middleCols(a * n, n) = r(a, 0) * half_turned_.leftCols(n) +
                                     r(a, 1) * half_turned_.middleCols(n, n) +
                                     r(a, 2) * half_turned_.rightCols(n);
    }
    const std::vector<int>& of_segment = graph_.segment_joints[s];
    Eigen::Index first_q = 0;
    for (std::size_t q = 0; q < of_segment.size(); ++q) {
      const PartGroup::Joint& joint_q = group_.joints()[static_cast<std::size_t>(of_segment[q])];
      Eigen::Index first_p = 0;
      for (std::size_t p = 0; p < of_segment.size(); ++p) {
        const PartGroup::Joint& joint_p = group_.joints()[static_cast<std::size_t>(of_segment[p])];
        const Block block = block_of(of_segment[p], of_segment[q]);
        // A transposed block is written when its two joints come the other way round.
        if (block.transposed) {
          first_p += joint_p.count;
          continue;
        }
        for (Eigen::Index b = 0; b < 3; ++b) {
          for (Eigen::Index j = 0; j < joint_q.count; ++j) {
            const Eigen::Index column =
                b * joint_q.count + segment.at[static_cast<std::size_t>(first_q + j)] - 3 * joint_q.first;
            for (Eigen::Index a = 0; a < 3; ++a) {
              for (Eigen::Index i = 0; i < joint_p.count; ++i) {
                const Eigen::Index row =
                    a * joint_p.count + segment.at[static_cast<std::size_t>(first_p + i)] - 3 * joint_p.first;
                (*block.matrix)(row, column) += turned_(a * n + first_p + i, b * n + first_q + j);
              }
            }
          }
        }
        first_p += joint_p.count;
      }
      first_q += joint_q.count;
    }
  }
}

void JointFactor::add_bones() {
  group_.each_bone_block([&](Eigen::Index at_a, Eigen::Index at_b, const Mat3& stiffness) {
    const auto a = static_cast<int>(group_.joint_at(at_a)), b = static_cast<int>(group_.joint_at(at_b));
    const PartGroup::Joint& joint_a = group_.joints()[static_cast<std::size_t>(a)];
    const PartGroup::Joint& joint_b = group_.joints()[static_cast<std::size_t>(b)];
    const Block block = block_of(a, b);
    if (block.transposed) return;
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j < 3; ++j) {
        (*block.matrix)(at_a - 3 * joint_a.first + i * joint_a.count,
                        at_b - 3 * joint_b.first + j * joint_b.count) += stiffness(i, j);
      }
    }
  });
}

void JointFactor::mask(const std::vector<char>& held, double steady, double shift) {
  for (std::size_t j = 0; j < diagonal_.size(); ++j) {
    const PartGroup::Joint& joint = group_.joints()[j];
    for (Eigen::Index i = 0; i < 3 * joint.count; ++i) {
      Eigen::MatrixXd& d = diagonal_[j];
      if (held[static_cast<std::size_t>(joint.first + i % joint.count)] == 0) {
        d(i, i) += steady + shift * (d(i, i) + steady);
        continue;
      }
      d.row(i).setZero();
      d.col(i).setZero();
      d(i, i) = 1.0;
      for (const auto& [later, link] : graph_.couplings[j])
        links_[static_cast<std::size_t>(link)].col(i).setZero();
    }
    for (const auto& [later, link] : graph_.couplings[j]) {
      const PartGroup::Joint& other = group_.joints()[static_cast<std::size_t>(later)];
      for (Eigen::Index i = 0; i < 3 * other.count; ++i) {
        if (held[static_cast<std::size_t>(other.first + i % other.count)] != 0) {
          links_[static_cast<std::size_t>(link)].row(i).setZero();
        }
      }
    }
  }
}

bool JointFactor::eliminate(double* scratch) {
  for (const int j : graph_.order) {
    Eigen::MatrixXd& d = diagonal_[static_cast<std::size_t>(j)];
    const Eigen::Index n = d.rows();
    if (!kernels_.cholesky(d.data(), n, n, scratch)) return false;
    const auto& couplings = graph_.couplings[static_cast<std::size_t>(j)];
    for (const auto& [later, link] : couplings) {
      Eigen::MatrixXd& v = links_[static_cast<std::size_t>(link)];
      kernels_.divide_transposed(v.data(), v.rows(), v.rows(), d.data(), n, n, scratch);
    }
    for (const auto& [a, link_a] : couplings) {
      for (const auto& [b, link_b] : couplings) {
        const Block block = block_of(a, b);
        if (block.transposed) continue;
        const Eigen::MatrixXd& va = links_[static_cast<std::size_t>(link_a)];
        const Eigen::MatrixXd& vb = links_[static_cast<std::size_t>(link_b)];
        kernels_.add_product(va.rows(), vb.rows(), n, -1.0, va.data(), 1, va.rows(), vb.data(), 1, vb.rows(),
                             block.matrix->data(), block.matrix->rows(), scratch);
      }
    }
  }
  return true;
}

void JointFactor::factor(const std::vector<char>& held, const Eigen::VectorXd& diagonal, double steady,
                         std::vector<double>& scratch) {
  reserve(scratch);
  held_ = held;
  // Stiffnesses that differ by more than sixteen digits may leave no positive pivot: then all are raised a
  // little.
  for (const double shift : {0.0, 1e-12, 1e-8, 1e-4, 1.0}) {
    for (std::size_t j = 0; j < diagonal_.size(); ++j) {
      const PartGroup::Joint& joint = group_.joints()[j];
      diagonal_[j] = diagonal.segment(3 * joint.first, 3 * joint.count).asDiagonal();
    }
    for (Eigen::MatrixXd& link : links_) link.setZero();
    add_segments();
    add_bones();
    mask(held, steady, shift);
    if (eliminate(scratch.data())) return;
  }
}

void JointFactor::solve(double* x, Eigen::Index rows, Eigen::Index ldx, std::vector<double>& shared) const {
  const auto& joints = group_.joints();
  double* const scratch = shared.data();
  const auto at = [&](int j) { return x + 3 * joints[static_cast<std::size_t>(j)].first * ldx; };
  for (std::size_t j = 0; j < joints.size(); ++j) {
    for (Eigen::Index i = 0; i < 3 * joints[j].count; ++i) {
      if (held_[static_cast<std::size_t>(joints[j].first + i % joints[j].count)] == 0) continue;
      double* const column = x + (3 * joints[j].first + i) * ldx;
      std::fill(column, column + rows, 0.0);
    }
  }
  for (const int j : graph_.order) {
    const Eigen::MatrixXd& d = diagonal_[static_cast<std::size_t>(j)];
    const Eigen::Index n = d.rows();
    kernels_.divide_transposed(at(j), rows, ldx, d.data(), n, n, scratch);
    for (const auto& [later, link] : graph_.couplings[static_cast<std::size_t>(j)]) {
      const Eigen::MatrixXd& v = links_[static_cast<std::size_t>(link)];
      kernels_.add_product(rows, v.rows(), n, -1.0, at(j), 1, ldx, v.data(), 1, v.rows(), at(later), ldx,
                           scratch);
    }
  }
  for (auto j = graph_.order.rbegin(); j != graph_.order.rend(); ++j) {
    const Eigen::MatrixXd& d = diagonal_[static_cast<std::size_t>(*j)];
    const Eigen::Index n = d.rows();
    for (const auto& [later, link] : graph_.couplings[static_cast<std::size_t>(*j)]) {
      const Eigen::MatrixXd& v = links_[static_cast<std::size_t>(link)];
      kernels_.add_product(rows, n, v.rows(), -1.0, at(later), 1, ldx, v.data(), v.rows(), 1, at(*j), ldx,
                           scratch);
    }
    kernels_.divide(at(*j), rows, ldx, d.data(), n, n, scratch);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

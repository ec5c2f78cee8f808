// The elastic-character paper's own method: cylinders of vertex-collocation boundary elements in the frames
// of their bones, joined by its equation (4), dx = kappa (-F1 - F2), so many times a frame. Bones join the
// middles of the interfaces; as in the paper they do not turn about their axis. Beside it the same with a
// frame fitted to both interfaces, and with one solution of all joints a frame, tangent held (which need not
// settle).
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <memory>

#include "benchmarks/bar_task.h"
#include "support/prism_section.h"
#include "support/vertex_collocation.h"

namespace softpoint::benchmarks {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kJoint = reference::kSides + 1;  // vertices of an interface: the middle first, then the ring
constexpr int kInner = 3 * reference::kSides;  // vertices of a part between its interfaces

enum class Frames { kBones, kFitted };

struct CollocationSettings {
  Frames frames;
  int iterations;  // of equation (4) a frame; 0: one dense solution a frame
};

// What all parts share: [traction at both interfaces; displacement between] = response * interface
// displacements.
struct Part {
  std::vector<Vec3> joints;  // rest, 2 * kJoint
  std::vector<Vec3> inner;   // rest, ring by ring upwards
  MatrixXd traction, displacement;
};

const Part& shared_part() {
  static const Part part = [] {
    const TriangleMesh mesh = reference::bar_mesh(1);
    const int last = mesh.vertex_count() - 1, top_ring = last - reference::kSides;
    std::vector<int> held(2 * kJoint);
    held[0] = 0;
    held[kJoint] = last;
    for (int k = 0; k < reference::kSides; ++k) {
      held[1 + k] = 1 + k;
      held[kJoint + 1 + k] = top_ring + k;
    }
    const MatrixXd response = elastic::reference::collocation_response(
        elastic::reference::collocate(mesh, {.young = kYoung, .poisson = kPoisson}), held);
    Part p;
    p.traction.resize(6 * kJoint, 6 * kJoint);
    for (int i = 0; i < 2 * kJoint; ++i) {
      p.joints.push_back(mesh.vertices[held[i]]);
      p.traction.middleRows<3>(3 * i) = response.middleRows<3>(3 * held[i]);
    }
    p.displacement = response.middleRows(3 * (1 + reference::kSides), 3 * kInner);
    for (int i = 0; i < kInner; ++i) p.inner.push_back(mesh.vertices[1 + reference::kSides + i]);
    return p;
  }();
  return part;
}

class CollocationBar : public Bar {
 public:
  CollocationBar(const BarTask& task, const CollocationSettings& settings)
      : task_(task), settings_(settings), part_(shared_part()), parts_(task.parts) {
    for (int j = 0; j <= parts_; ++j) {
      for (int i = 0; i < kJoint; ++i) {
        x_.push_back(part_.joints[i] + Vec3(0.0, 0.0, j * reference::kPartLength - 0.5 * (parts_ - 1)));
      }
    }
    rest_ = x_;
    rotation_.assign(parts_, Mat3::Identity());
    middle_.resize(parts_);
    local_.resize(6 * kJoint, parts_);
    traction_.resize(6 * kJoint, parts_);
    moving_ = parts_ - (task.is_held() ? 1 : 0);  // interfaces 1 to moving_
    kappa_ = 1.9 / largest_eigenvalue();
  }

  void frame(double load) override {
    if (task_.is_held()) {
      const EndPose pose = task_.pose(load);
      const Mat3 turn = pose.rotation();
      const Vec3 centre = rest_[parts_ * kJoint];
      for (int i = 0; i < kJoint; ++i) {
        x_[parts_ * kJoint + i] = centre + pose.shift + turn * (rest_[parts_ * kJoint + i] - centre);
      }
    } else {
      const double area = reference::prism_section(reference::kSides, reference::kRadius).area;
      pull_ = task_.force(load) / area;
    }
    if (settings_.iterations == 0) {
      evaluate();
      solve_joints();
    }
    for (int n = 0; n < settings_.iterations; ++n) {
      evaluate();
      const VectorXd r = residual();
      for (int i = 0; i < kJoint * moving_; ++i) x_[kJoint + i] += kappa_ * r.segment<3>(3 * i);
    }
    evaluate();
    const MatrixXd between = part_.displacement * local_;  // the skin that is shown
    skin_.resize(static_cast<std::size_t>(parts_) * kInner);
    for (int p = 0; p < parts_; ++p) {
      for (int i = 0; i < kInner; ++i) {
        skin_[p * kInner + i] =
            middle_[p] + rotation_[p] * (part_.inner[i] + between.col(p).segment<3>(3 * i));
      }
    }
  }

  std::vector<Vec3> vertices() const override {
    std::vector<Vec3> result = {x_[0]};
    for (int p = 0; p <= parts_; ++p) {
      result.insert(result.end(), x_.begin() + p * kJoint + 1, x_.begin() + (p + 1) * kJoint);
      if (p < parts_)
        result.insert(result.end(), skin_.begin() + p * kInner, skin_.begin() + (p + 1) * kInner);
    }
    result.push_back(x_[parts_ * kJoint]);
    return result;
  }

  std::optional<Vec3> end_force() const override { return resultant().first; }
  std::optional<Vec3> end_moment() const override { return resultant().second; }
  double iterations() const override { return std::max(settings_.iterations, 1); }

 private:
  const Vec3& joint(int part, int i) const { return x_[part * kJoint + i]; }  // i over both interfaces

  void place(int p) {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    for (int i = 0; i < kJoint; ++i) low += joint(p, i) / kJoint, high += joint(p, kJoint + i) / kJoint;
    middle_[p] = 0.5 * (low + high);
    if (settings_.frames == Frames::kBones) {
      rotation_[p] = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), high - low).toRotationMatrix();
      return;
    }
    Mat3 sum = Mat3::Zero();
    for (int i = 0; i < 2 * kJoint; ++i) sum += (joint(p, i) - middle_[p]) * part_.joints[i].transpose();
    const Eigen::JacobiSVD<Mat3> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Mat3 u = svd.matrixU(), v = svd.matrixV();
    const Vec3 sign(1.0, 1.0, u.determinant() * v.determinant() < 0 ? -1.0 : 1.0);
    rotation_[p] = u * sign.asDiagonal() * v.transpose();
  }

  // Tractions of all parts, in their own frames.
  void evaluate() {
    for (int p = 0; p < parts_; ++p) {
      place(p);
      for (int i = 0; i < 2 * kJoint; ++i) {
        local_.col(p).segment<3>(3 * i) =
            rotation_[p].transpose() * (joint(p, i) - middle_[p]) - part_.joints[i];
      }
    }
    traction_.noalias() = part_.traction * local_;
  }

  // -F1 - F2 at every vertex of the interfaces that move.
  VectorXd residual() const {
    VectorXd r = VectorXd::Zero(3 * kJoint * moving_);
    for (int p = 0; p < parts_; ++p) {
      for (int i = 0; i < 2 * kJoint; ++i) {
        const int to = (p - 1) * kJoint + i;
        if (to < 0 || to >= kJoint * moving_) continue;
        r.segment<3>(3 * to) -= rotation_[p] * traction_.col(p).segment<3>(3 * i);
      }
    }
    if (!task_.is_held()) {
      for (int i = 0; i < kJoint; ++i) r.segment<3>(3 * ((moving_ - 1) * kJoint + i)) += pull_;
    }
    return r;
  }

  // -d residual / dx with the frames held.
  MatrixXd tangent() const {
    const int size = 3 * kJoint * moving_;
    MatrixXd all = MatrixXd::Zero(size, size);
    for (int p = 0; p < parts_; ++p) {
      MatrixXd block = part_.traction;
      for (int i = 0; i < 2 * kJoint; ++i) {
        block.middleRows<3>(3 * i) = (rotation_[p] * block.middleRows<3>(3 * i)).eval();
      }
      for (int i = 0; i < 2 * kJoint; ++i) {
        block.middleCols<3>(3 * i) = (block.middleCols<3>(3 * i) * rotation_[p].transpose()).eval();
      }
      const int start = 3 * kJoint * (p - 1);
      const int skip = std::max(0, -start), count = std::min(size - start, 6 * kJoint) - skip;
      if (count > 0)
        all.block(start + skip, start + skip, count, count) += block.block(skip, skip, count, count);
    }
    return all;
  }

  void solve_joints() {
    const VectorXd step = tangent().partialPivLu().solve(residual());
    for (int i = 0; i < kJoint * moving_; ++i) x_[kJoint + i] += step.segment<3>(3 * i);
  }

  // Of the straight chain, by which equation (4) converges or not.
  double largest_eigenvalue() const {
    const MatrixXd a = tangent();
    VectorXd v = VectorXd::Ones(a.cols());
    for (int i = 0; i < v.size(); ++i) v[i] += 0.5 * std::sin(1.7 * i);
    double value = 0.0;
    for (int n = 0; n < 300; ++n) {
      v.normalize();
      v = a * v;
      value = v.norm();
    }
    return value;
  }

  // Integrals of the traction, linear over the cap's triangles.
  std::pair<Vec3, Vec3> resultant() const {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    const int p = parts_ - 1;
    const auto traction = [&](int i) -> Vec3 {
      return rotation_[p] * traction_.col(p).segment<3>(3 * (kJoint + i));
    };
    const double third =
        reference::prism_section(reference::kSides, reference::kRadius).area / reference::kSides / 3.0;
    const Vec3 centre = joint(p, kJoint);
    for (int k = 0; k < reference::kSides; ++k) {
      const int corner[3] = {0, 1 + k, 1 + (k + 1) % reference::kSides};
      Vec3 sum = Vec3::Zero();
      for (int c : corner) sum += joint(p, kJoint + c) - centre;
      for (int c : corner) {
        const Vec3 t = traction(c);
        force += third * t;
        moment += 0.25 * third * (joint(p, kJoint + c) - centre + sum).cross(t);
      }
    }
    return {force, moment};
  }

  BarTask task_;
  CollocationSettings settings_;
  const Part& part_;
  int parts_, moving_ = 0;
  double kappa_ = 0;
  std::vector<Vec3> x_, rest_, skin_;
  std::vector<Mat3> rotation_;
  std::vector<Vec3> middle_;
  MatrixXd local_, traction_;
  Vec3 pull_ = Vec3::Zero();
};

}  // namespace

std::vector<Contestant> collocation_contestants() {
  std::vector<Contestant> result;
  const auto add = [&](const std::string& name, const CollocationSettings& settings) {
    result.push_back({"the paper", name, [settings](const BarTask& task) -> std::unique_ptr<Bar> {
                        return std::make_unique<CollocationBar>(task, settings);
                      }});
  };
  for (int n : {1, 10, 100, 1000}) add("(4) x " + std::to_string(n), {Frames::kBones, n});
  add("bones, one dense solution", {Frames::kBones, 0});
  add("fitted frames, one dense solution", {Frames::kFitted, 0});
  return result;
}

}  // namespace softpoint::benchmarks

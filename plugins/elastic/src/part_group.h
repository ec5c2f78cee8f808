#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <vector>

#include "bone_energy.h"
#include "placed_design.h"
#include "product.h"
#include "surface_turns.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Blocks of a symmetric matrix by row and column, both triangles; absent ones are zero.
using BlockRows = std::vector<std::map<std::size_t, Eigen::MatrixXd>>;

// The blocks of a segment model, laid out for products.
struct PackedModel {
  const SegmentModel* model = nullptr;
  const Kernels* kernels = nullptr;
  Product stiffness;                                   // K
  Product exact_stiffness;                             // K in double precision
  Product free_response;                               // Phi
  Eigen::Matrix<double, Eigen::Dynamic, 3> free_rest;  // m, of the free vertices, in the mesh's frame
  Eigen::Matrix<double, Eigen::Dynamic, 3> arms;       // X of the joint points from their mean
  Vec3 mean = Vec3::Zero();                            // m, of the joint points, in the mesh's frame
  Vec3 first_moment = Vec3::Zero();                    // m4, integral of x from the mean over the volume
};
std::shared_ptr<const PackedModel> pack_model(const SegmentModel& model, const Kernels& kernels, bool single);

// A force on a free vertex of a segment.
struct SkinPush {
  int segment = 0, free_point = 0;  // of the group; of its model
  Vec3 force = Vec3::Zero();        // N, world
};

// Mechanics of one character's parts that hang together. Vectors of points are joint by joint, axis-major
// inside: component a of point i of joint j is 3 first(j) + a count(j) + i.
//
// Each segment is linear in a frame R of its own, the best fit of its joint points; its energy is
// 1/2 d K d, d = R^T (x - mean) - X. Forces are the exact gradient, change of R included, so they have
// neither net force nor net moment (doc/joined_segments.md).
class PartGroup {
 public:
  struct Joint {
    Eigen::Index first = 0, count = 0;  // points
    Mat3 turn = Mat3::Identity();       // from the rest pose: mean of the segments that meet here
    std::array<int, 2> segments = {-1, -1};
  };
  struct Segment {
    int model = 0;   // of models()
    int column = 0;  // among the segments of that model
    int placed = 0;  // of the placed design
    Mat3 rest_rotation = Mat3::Identity();
    Mat3 rotation = Mat3::Identity();         // R
    Mat3 stretch_inverse = Mat3::Identity();  // (tr(S) 1 - S)^-1 of the fit
    Vec3 mean = Vec3::Zero();                 // m, of its joint points
    std::vector<Eigen::Index> at, stride;     // where its joint points are
  };
  struct Bone {
    BoneSettings settings;
    BoneShape shape;
    std::vector<Eigen::Index> at, stride;  // its joints' first points
    int part = 0;                          // of the design
  };

  PartGroup(const AssemblyDesign& design, const PlacedDesign& placed, int group,
            const std::vector<std::shared_ptr<const PackedModel>>& models);

  // Whether from now on the strain of joining surfaces is measured by their rotation vectors, (J8).
  void turn_surfaces(bool on);
  // Frames and displacements of the segments at `x`, without forces: all that the skin wants.
  void fit_all(const Eigen::VectorXd& x);
  // Energy (J), gradient (N) at `x`. Moves the segments' frames along.
  double evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& gradient);
  // Forces (N) by small displacements (m) of the points, the segments' frames of the last evaluate() held.
  void stiffness_product(const Eigen::VectorXd& displacement, Eigen::VectorXd& force);
  // Turns of the joints from the frames of the last evaluate().
  void update_turns();
  // Largest turn (rad) of a segment against a neighbour since the rest pose, as of the last evaluate().
  double largest_turn() const;
  // Stiffness at rest without `held` points, plus `inertia` (kg/s2) for each point.
  BlockRows rest_stiffness(const std::vector<char>& held, const Eigen::VectorXd& inertia) const;
  // Largest stiffness (N/m) against moving the first point of a joint alone, all others held.
  double point_stiffness(std::size_t joint) const;
  // Of the segments alone at the last evaluate(), J.
  double elastic_energy() const { return elastic_energy_; }
  // Sum of |K| |d|^2 at the last evaluate(), J: rounding of the energy is a small part of this, not of the
  // energy, which is far less where joints hardly strain.
  double energy_scale() const { return energy_scale_; }
  // Norm of the segments' joint forces at the last evaluate() (N), against which imbalance is measured.
  double force_scale() const { return force_scale_; }
  // A force that would strain all of the group by one (N).
  double stiffness_scale() const { return stiffness_scale_; }
  // Local joint displacements of the last evaluate(), column by column of a model; what their forces come from.
  const std::vector<double>& displacements(int model) const {
    return batches_[static_cast<std::size_t>(model)].displacements;
  }
  const std::vector<double>& strains(int model) const {
    const Batch& batch = batches_[static_cast<std::size_t>(model)];
    return batch.turns.empty() ? batch.displacements : batch.strains;
  }

  Eigen::Index points() const { return points_; }
  Eigen::Index size() const { return 3 * points_; }
  Vec3 point(const Eigen::VectorXd& v, Eigen::Index at, Eigen::Index stride) const {
    return {v[at], v[at + stride], v[at + 2 * stride]};
  }
  // Joint of the point whose first coordinate is there.
  std::size_t joint_at(Eigen::Index at) const;
  // Stiffness of the bones at the shape of the last evaluate(), as calls of add(at of one joint's first
  // point, at of another's, block): the squares of stretch and of the change of direction, directions held.
  template <class Add>
  void each_bone_block(Add&& add) const {
    each_bone_block(last_, add);
  }
  // Number of the point whose first coordinate is there.
  std::size_t index_of(Eigen::Index at) const;
  const std::vector<Joint>& joints() const { return joints_; }
  const std::vector<int>& joint_ids() const { return joint_ids_; }  // of the placed design
  std::vector<Segment>& segments() { return segments_; }
  const std::vector<Segment>& segments() const { return segments_; }
  const std::vector<Bone>& bones() const { return bones_; }
  const std::vector<std::shared_ptr<const PackedModel>>& models() const { return models_; }
  const Eigen::VectorXd& rest() const { return rest_; }
  // Mean distance of neighbouring joints at rest, m.
  double spacing() const { return spacing_; }

  Vec3 gravity = Vec3::Zero();   // m/s2, as long as it acts on the segments' volume
  std::vector<SkinPush> pushes;  // forces on free vertices
  Eigen::VectorXd loads;         // N, world, on the joints' points
  long long products = 0;        // segments multiplied so far

 private:
  struct Batch {
    std::vector<int> segments;
    std::vector<double> displacements, forces;  // 3J x n, padded x n
    std::vector<double> probes;                 // 3J x n, of stiffness_product()
    std::vector<SurfaceTurns> turns;            // one or none
    std::vector<double> strains;                // 3J x n, with turns
  };
  void fit(Segment& segment, const Eigen::VectorXd& x, double* local);
  template <class Add>
  void each_bone_block(const Eigen::VectorXd& x, Add&& add) const;
  double bones(const Eigen::VectorXd& x, Eigen::VectorXd& gradient);
  void bone_product(const Eigen::VectorXd& displacement, Eigen::VectorXd& force) const;

  Eigen::Index points_ = 0;
  std::vector<Joint> joints_;
  std::vector<int> joint_ids_;
  std::vector<Segment> segments_;
  std::vector<Bone> bones_;
  std::vector<std::shared_ptr<const PackedModel>> models_;
  std::vector<Batch> batches_;
  Eigen::VectorXd rest_;
  Eigen::VectorXd last_;  // points of the last evaluate()
  double energy_scale_ = 0;
  double elastic_energy_ = 0, force_scale_ = 0, stiffness_scale_ = 0, spacing_ = 0;
  const Kernels& kernels_;
  std::vector<float> scratch_;
  std::vector<double> gathered_;  // 3J
  std::vector<Vec3> bone_points_, bone_gradient_;
};

template <class Add>
void PartGroup::each_bone_block(const Eigen::VectorXd& x, Add&& add) const {
  for (const Bone& bone : bones_) {
    const double k = bone.settings.length_stiffness, c = bone.settings.angle_stiffness;
    if (k == 0.0 && c == 0.0) continue;
    for (std::size_t i = 1; i < bone.at.size(); ++i) {
      const Vec3 edge = point(x, bone.at[i], bone.stride[i]) - point(x, bone.at[i - 1], bone.stride[i - 1]);
      const Vec3 along = edge / std::max(edge.norm(), 1e-12 * bone.shape.lengths[i - 1]);
      const Mat3 stretch = k * along * along.transpose();
      add(bone.at[i], bone.at[i], stretch);
      add(bone.at[i - 1], bone.at[i - 1], stretch);
      add(bone.at[i], bone.at[i - 1], -stretch);
      add(bone.at[i - 1], bone.at[i], -stretch);
      if (i < 2 || c == 0.0) continue;
      const double before = bone.shape.lengths[i - 2], after = bone.shape.lengths[i - 1];
      const std::array<double, 3> weight = {1.0 / before, -1.0 / before - 1.0 / after, 1.0 / after};
      const Mat3 across = Mat3::Identity() - along * along.transpose();
      for (std::size_t p = 0; p < 3; ++p) {
        for (std::size_t q = 0; q < 3; ++q) {
          add(bone.at[i - 2 + p], bone.at[i - 2 + q], c * weight[p] * weight[q] * across);
        }
      }
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

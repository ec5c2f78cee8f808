#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

#include "softpoint/core/vec.h"
#include "softpoint/elastic/segment_model.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// How far each interface of a segment turns within the segment's frame, as a rotation vector: a linear
// segment takes an interface that has turned by sin(t) for one that has shrunk by 1 - cos(t), and resists.
// With d the displacements of an interface's points, s their mean, X the points at rest from their mean and
// Q the rotation nearest to what became of them,
//   strain d~ = s + log(Q) x X + Q^T (X + d - s) - X,                                            (J8)
// which is d to first order. Between two interfaces the middle line bends as well and draws them together:
// with e the unit vector from one to the other at rest, L their distance, phi_i what they turn against the
// line between them, p and q half their difference and half their sum,
//   s_2 - s_1 -> s_2 - s_1 + L (5 p^2 + 3 c q^2)/30 e,   c = (K_q/(3 K_p))^2,                      (J9)
// K_p and K_q the segment's stiffness against both: 1 of a slender beam, less where shear takes part.
// Arrays are axis-major, all joint points of a segment.
class SurfaceTurns {
 public:
  // For `n` segments of a model whose joint points at rest are `arms` (J x 3).
  SurfaceTurns(const SegmentModel& model, const Eigen::Matrix<double, Eigen::Dynamic, 3>& arms,
               Eigen::Index n);

  // (J8) of segment `column`; remembers Q for the two below.
  void straighten(Eigen::Index column, const double* d, double* strain);
  // From dE/d(strain) to dE/dd, in place.
  void turn_forces(Eigen::Index column, const double* strain, double* force) const;
  // First-order change of the strain by a change of d, in place.
  void turn_change(Eigen::Index column, const double* strain, double* change) const;

 private:
  struct Turn {
    Mat3 rotation = Mat3::Identity();    // Q
    Mat3 fit = Mat3::Zero();             // (tr(S) 1 - S)^-1 of S = sum Q^T (X + d - s) X^T
    Mat3 rate = Mat3::Identity();        // of the rotation vector by a turn in the turned frame
    Vec3 vector = Vec3::Zero();          // log Q, rad
    Vec3 shift = Vec3::Zero();           // s, m
    Vec3 strained_shift = Vec3::Zero();  // with what (J9) adds
  };
  struct Bow {
    Vec3 half_difference = Vec3::Zero(), half_sum = Vec3::Zero();  // p and q, rad
  };
  // dE/d(phi) of both interfaces by a force that draws them together.
  std::array<Vec3, 2> bow_moments(const Bow& bow, double force) const;
  // Q^T (X + d - s) of point k.
  Vec3 turned_back(const Turn& turn, const double* strain, Eigen::Index k) const;

  std::vector<Eigen::Index> first_;  // of each interface's points, and their number last
  Eigen::Matrix<double, Eigen::Dynamic, 3> arms_;
  std::vector<Turn> turns_;   // interface by interface, segment by segment
  std::vector<Bow> bows_;     // segment by segment, of two interfaces
  Vec3 axis_ = Vec3::Zero();  // e
  double length_ = 0;         // L, m
  double shear_ = 1;          // c
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

#pragma once

#include <array>
#include <span>
#include <vector>

#include "softpoint/figure/figure_collision.h"
#include "softpoint/figure/figure_dynamics.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Impulses between a figure and what it touches, fixed or not: v+ = v + H^-1 J^T p with Coulomb's cone at
// each contact, found by projected Gauss-Seidel on the contacts' own mobility matrix.
class ContactImpulses {
 public:
  struct Contact {
    int link = 0;
    Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();  // m, world
    double lowest = 0;     // m/s, the speed along the normal that is not to be fallen short of
    int other = -1;        // which of the bodies that give way; -1: the world
    double friction = -1;  // coefficient; negative: the one for all
  };
  // A rigid body that is touched.
  struct Other {
    Vec3 center = Vec3::Zero(), velocity = Vec3::Zero(), spin = Vec3::Zero();  // m, m/s, rad/s
    double inverse_mass = 0;                                                   // 1/kg
    Mat3 inverse_inertia = Mat3::Zero();                                       // 1/(kg m2), world axes
  };

  // At most so many sweeps, fewer if none changes an impulse by more than `settled` of the largest.
  explicit ContactImpulses(const FigureModel& model, int sweeps = 2000, double settled = 1e-14);
  // `dynamics` has just had forward() in the positions `q`. Changes `qd` of the dynamic joints; `impulses()`
  // (N s, world) are those on the figure; the others get the opposite.
  void solve(FigureDynamics& dynamics, const double* q, double friction, const std::vector<Contact>& contacts,
             double* qd, std::span<const Other> others = {});
  const std::vector<Vec3>& impulses() const { return impulses_; }
  // Moves the dynamic joints (`d`, one number a degree of freedom) so that gaps grow by `lowest` (m) each.
  void push_out(FigureDynamics& dynamics, const double* q, const std::vector<Contact>& contacts, double* d);

 private:
  void assemble(FigureDynamics& dynamics, const double* q, const std::vector<Contact>& contacts,
                const double* qd, std::span<const Other> others);
  Vec3 speed(const FigureDynamics& placed, const Contact& contact) const;

  FigureDynamics placer_;
  std::vector<double> changes_;  // per contact and axis: of all rates, by a unit impulse
  std::vector<Vec3> mobility_;   // m x 3m: speed at contact i by a unit impulse along axis k of contact j
  std::vector<Vec3> speeds_, impulses_;
  std::array<Wrench, 1> unit_;
  int sweeps_;
  double settled_;
  std::size_t rates_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

#pragma once

#include <vector>

#include "softpoint/figure/figure_collision.h"
#include "softpoint/figure/figure_dynamics.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Impulses between a figure and fixed surroundings: v+ = v + H^-1 J^T p with Coulomb's cone at each contact,
// found by projected Gauss-Seidel on the contacts' own mobility matrix.
class ContactImpulses {
 public:
  struct Contact {
    int link = 0;
    Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();  // m, world
    double lowest = 0;  // m/s, the speed along the normal that is not to be fallen short of
  };

  explicit ContactImpulses(const FigureModel& model);
  // `dynamics` has just had forward() in the positions `q`. Changes `qd` of the dynamic joints; `impulses()`
  // (N s, world) are those on the figure.
  void solve(FigureDynamics& dynamics, const double* q, double friction, const std::vector<Contact>& contacts,
             double* qd);
  const std::vector<Vec3>& impulses() const { return impulses_; }
  // Moves the dynamic joints (`d`, one number a degree of freedom) so that gaps grow by `lowest` (m) each.
  void push_out(FigureDynamics& dynamics, const double* q, const std::vector<Contact>& contacts, double* d);

 private:
  void assemble(FigureDynamics& dynamics, const double* q, const std::vector<Contact>& contacts,
                const double* qd);
  Vec3 speed(const FigureDynamics& placed, const Contact& contact) const;

  FigureDynamics placer_;
  std::vector<double> changes_;  // per contact and axis: of all rates, by a unit impulse
  std::vector<Vec3> mobility_;   // m x 3m: speed at contact i by a unit impulse along axis k of contact j
  std::vector<Vec3> speeds_, impulses_;
  std::size_t rates_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

#pragma once

#include <vector>

#include "placing-inl.h"
#include "softpoint/core/vec.h"
#include "tree.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// The discrete mechanics of one step, (17) to (20) of doc/dynamics.md: momenta of the bodies between two
// poses and what the joints have of them at either.
class VariationalStep {
 public:
  explicit VariationalStep(const FigureModel& model);

  // Momenta of the joints in the state a step begins from; `gravity` (m/s2) acts throughout.
  void begin(const double* q, const double* qd, const Vec3& gravity);
  // Where the step of `h` s ends: `q` is what it began from moved by `d`.
  void end(const double* q, const double* d, double h);

  // (18): p - what the joints have at the beginning; zero when the end is right.
  void residual(double* r);
  // (19): momenta of the joints at the end.
  void momenta(double* p);

 private:
  void project(const std::vector<BodyWork<double>>& at, double half_step, double* p);
  void place(const double* q, const double* qd, std::vector<BodyWork<double>>& at);

  struct Weight {
    V3<double> center;   // m, of mass, in body axes
    S3<double> inertia;  // kg m2, about it
  };
  Tree tree_;
  std::vector<Weight> weights_;
  std::vector<BodyWork<double>> begin_, end_;
  std::vector<V3<double>> moved_;     // m, of the joint in the step
  std::vector<V6<double>> momentum_;  // of the body, about its centre of mass: one for the step
  std::vector<V6<double>> carried_;   // of what hangs on the joint, about it
  std::vector<double> p_, own_, still_, first_;
  V3<double> gravity_{0, 0, 0};
  double h_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

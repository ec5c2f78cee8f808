#pragma once

#include "softpoint/figure/figure_model.h"

// States as points of a Lie group: steps are increments `d`, one number a degree of freedom (rad, m), in the
// axes of the joint's velocities; (10) to (12) of doc/dynamics.md.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// q1 = q0 moved by d: R0 exp(d) of a ball, exp(d) R0 of a free joint. Quaternions stay unit ones. q1 may be
// q0.
void move_by(const FigureModel& model, const double* q0, const double* d, double* q1);
// Rate of the increment at which a figure that was moved by `d` has the velocities `qd`.
void increment_rate(const FigureModel& model, const double* d, const double* qd, double* rate);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

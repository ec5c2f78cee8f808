#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "softpoint/figure/figure_stepper.h"
#include "softpoint/figure/spline.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Motion of joints from a table: a header `t,<joint>,...`, then a row of numbers a time. A hinge or prismatic
// joint has one column, its name; a ball the four <joint>.qw, .qx, .qy, .qz; a free joint these and .px, .py,
// .pz. Blank lines and what follows a # count for nothing. Between the rows C2 splines, whose velocities and
// accelerations are their derivatives.
class FigurePrescription : public figure::PrescribedMotion {
 public:
  // Throws Error naming file, line, column and what is permitted.
  FigurePrescription(std::string_view text, const std::string& file, const figure::FigureModel& model);

  // The links whose joints it moves, and the times from first to last row, s.
  const std::vector<int>& links() const { return links_; }
  double first_time() const { return first_time_; }
  double last_time() const { return last_time_; }

  void evaluate(double time, double* q, double* qd, double* qdd) const override;

 private:
  struct Line {
    int q, v;
    figure::CubicSpline curve;
  };
  struct Turn {
    int q, v;
    bool free;  // velocities in the axes of the world, not the child's
    figure::TurnSpline curve;
  };
  std::vector<int> links_;
  std::vector<Line> lines_;
  std::vector<Turn> turns_;
  double first_time_ = 0, last_time_ = 0;
};

FigurePrescription read_figure_prescription(const std::filesystem::path& path,
                                            const figure::FigureModel& model);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

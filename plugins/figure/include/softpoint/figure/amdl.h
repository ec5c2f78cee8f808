#pragma once

#include <iosfwd>
#include <string>

#include "softpoint/figure/figure_model.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// A figure as plain text, one link a line, parents first; what follows a # is a comment:
//   name parent type  axis(3)  origin(3)  mass  centre_of_mass(3)  Ixx Iyy Izz Ixy Ixz Iyz  lower upper
// parent: line number from 0, -1 is the world. type: 0 free, 1 hinge, 2 ball, 3 prismatic, 4 fixed. axis,
// origin and centre of mass in the parent's and the link's own frame as in Link; all frames are aligned at q
// = 0. Inertia about the centre of mass. A ball's line may go on with
//   swing_about swing_across swing_axis(3)
// and has a cone then; axis, lower and upper are those of its twist. SI units. Throws Error naming the line.
SOFTPOINT_API FigureModel read_amdl(std::istream& in, const std::string& name);
SOFTPOINT_API FigureModel read_amdl_file(const std::string& path);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

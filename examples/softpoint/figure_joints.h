#pragma once

#include <string>

#include "softpoint/figure/figure_model.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// The link whose joint has that name. Throws Error, headed by `where`, that lists the names there are.
int find_joint(const figure::FigureModel& model, const std::string& name, const std::string& where);
// The link that hangs on the world by a free joint; -1 if there is none. Throws Error if there are several:
// files of states and traces know one base.
int find_base(const figure::FigureModel& model);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

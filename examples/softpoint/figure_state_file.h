#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "softpoint/figure/figure_model.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// STATE.json of `softpoint figure`: an object with, each optional and then at rest,
//   base  {position, orientation [w, x, y, z], angular_velocity, velocity}: of the free link's frame, world
//         axes;
//   q, qd lists with an entry a joint in the order of the model, the free and the fixed ones left out: a
//         number (hinge, prismatic), or of a ball [w, x, y, z] and three rates in the child's axes.
// Throws Error naming file, place, value and what is permitted.
figure::FigureState read_figure_state(const std::filesystem::path& path, const figure::FigureModel& model);
// The same from a text; `file` heads the messages.
figure::FigureState read_figure_state(std::string_view text, const std::string& file,
                                      const figure::FigureModel& model);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

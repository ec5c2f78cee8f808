#pragma once

#include <filesystem>
#include <string>

#include "json_reader.h"
#include "softpoint/elastic/statics.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// The reader of PROBLEM.json: mesh, material, displacement, traction, gravity.
void read_static_problem(ObjectReader& root, elastic::StaticProblem& problem);

// Throws Error for whatever the file, or the mesh it names, does wrong.
elastic::StaticProblem read_static_problem(const std::filesystem::path& path);

// RESULT.json: displacement, nodal_force, traction, energy, free_rigid_motions, seconds. Every number
// reads back as the same double. Throws Error if one is not finite.
std::string static_result_json(const elastic::StaticResult& result);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

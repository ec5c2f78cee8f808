#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "json_reader.h"
#include "softpoint/figure/figure_animation.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

struct RigidBodySpec;

// What the links of a figure in a scene are made of.
struct FigureLinks {
  std::vector<figure::Link> links;
  std::vector<figure::LinkCapsule> capsules;
  std::vector<std::pair<int, double>> paper_friction;  // link and factor
};

// Reads one of "links"; its index is the number of links before it.
void read_figure_link(ObjectReader& item, FigureLinks& parts);

// Index of the link of that name; refuses `key` if there is none.
int figure_link_index(const ObjectReader& item, std::string_view key, const std::string& name,
                      const std::vector<figure::Link>& links);

// What of a scene's bodies stands still and can be touched.
std::vector<figure::Obstacle> figure_obstacles(const std::vector<RigidBodySpec>& bodies);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

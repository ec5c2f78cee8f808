#pragma once

#include <string>
#include <vector>

#include "softpoint/figure/figure_collision.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// How the root of a robot stands in the world: the format does not say.
enum class UrdfBase {
  kAuto,   // free if the root link has a mass, fixed if not
  kFixed,  // to the world
  kFree
};

// Whether this library was built with liburdfdom; without it reading throws.
SOFTPOINT_API bool has_urdf();
// A figure from a robot description (URDF). Links in the order of the tree, each called like its link, the
// joint (`Link::joint_name`) like the joint above it: revolute, continuous, prismatic and fixed joints, a
// floating one under a root without mass, and Bullet's spherical ones; with ranges, viscous and dry friction.
// `capsules`, unless null, takes the shapes for collision: Bullet's capsules and spheres as they are, of
// cylinders and boxes the largest capsule along the cylinder or the box's longest edge that fits inside;
// meshes are left out. Throws Error for what the parser refuses, naming its reason, for planar and mimicking
// joints, and for what FigureModel refuses; `capsules` is then as before.
SOFTPOINT_API FigureModel read_urdf(const std::string& text, const std::string& name,
                                    UrdfBase base = UrdfBase::kAuto,
                                    std::vector<LinkCapsule>* capsules = nullptr);
SOFTPOINT_API FigureModel read_urdf_file(const std::string& path, UrdfBase base = UrdfBase::kAuto,
                                         std::vector<LinkCapsule>* capsules = nullptr);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

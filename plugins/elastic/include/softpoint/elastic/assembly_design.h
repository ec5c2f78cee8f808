#pragma once

#include <memory>
#include <string>
#include <vector>

#include "softpoint/core/vec.h"
#include "softpoint/elastic/segment_model.h"

// What an elastic character is made of: parts, each a row of segments along an unbranched bone, joined end
// to end by equal joining surfaces, and to patches of other parts.
namespace softpoint::inline SOFTPOINT_ABI::elastic {

// The bone of a part runs through the first vertex of each joining surface. Its forces act on these
// vertices: length, equation (5) of the paper with alpha = beta = `length_stiffness`, along each bone; angle,
// equation (6) with gamma = `angle_stiffness` / L_i and eta = `angle_stiffness` / L_i+1, which makes them
// the gradient of angle_stiffness/2 (theta - theta_0)^2, the opposite forces acting on the neighbours.
struct BoneSettings {
  double length_stiffness = 0;  // N/m of each bone, 0 to 1e15
  double angle_stiffness = 0;   // N m/rad of each joint between two bones, 0 to 1e15
  double mass = 0;              // kg of each joint, 0 to 1e9: the joints' equation of motion
  double damping = 0;           // N s/m of each joint against its own velocity, 0 to 1e12
};

// Segments along a bone, straight at rest. Interface 0 of a segment faces the root, interface 1 the tip;
// further ones are patches for other parts. Each tip interface must meet the next root interface vertex by
// vertex, in the same order.
struct PartDesign {
  std::string name;                                           // for messages
  std::vector<std::shared_ptr<const SegmentModel>> segments;  // root to tip, one or more
  Vec3 root = Vec3::Zero();          // m: where the first vertex of the first root interface lies at rest
  Mat3 rotation = Mat3::Identity();  // of all the segments' meshes
  BoneSettings bone;
};

// One of the two ends of a part's bone, with the joining surface there.
struct PartEnd {
  int part = 0;
  bool tip = false;
};

// A joining surface on the side of a part.
struct Patch {
  int part = 0;
  int segment = 0;    // of that part
  int interface = 2;  // of that segment, 2 or more
};

// An end of a part joined to a patch of another one: each vertex of the end to one of the patch, whichever
// lies there at rest.
struct Join {
  PartEnd end;
  Patch patch;
};

// All parts of a character, at rest.
struct AssemblyDesign {
  std::vector<PartDesign> parts;
  std::vector<Join> joins;

  // A row of `count` equal segments from `root` along `rotation` z. Returns the part's index.
  SOFTPOINT_API int add_row(std::string name, std::shared_ptr<const SegmentModel> segment, int count,
                            const Vec3& root = Vec3::Zero(), const Mat3& rotation = Mat3::Identity(),
                            const BoneSettings& bone = {});
};

// Throws Error naming the part, the field, its value and what is permitted: no parts or segments, a null
// model, interfaces that do not meet one to one, parts joined to themselves, an end or patch joined twice,
// bone settings or places out of range.
SOFTPOINT_API void check(const AssemblyDesign& design);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

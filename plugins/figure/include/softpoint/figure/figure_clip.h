#pragma once

#include <vector>

#include "softpoint/figure/figure_collision.h"
#include "softpoint/figure/integrator.h"
#include "softpoint/figure/keyframes.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Joints left to zero-torque dynamics between two times. They begin with the position and rate that the keys
// before `begin` give them, and the keys after `end` go on from what comes out; keys in between are passed
// over.
struct DynamicInterval {
  double begin = 0, end = 0;  // s
  std::vector<int> links;     // joints; a substructure usually
};

// What the place of the whole figure goes by. Only for figures whose first link is free.
enum class PlaceRule {
  kKeyed,    // the first link's own keys
  kFeet,     // those too, and the limbs of `link` and `other` bend so that a point of each stays where it is
  kPin,      // a point of a link stays where it is
  kGravity,  // section 3.2 of the paper: that point while the figure touches something, else free flight
  kContact,  // by dynamics: flight with its momentum, inelastic landing, friction; the base's turn too
  kHold  // by dynamics, with a point of `link`, and that of `other`, held where it is; nothing else touches
};

// A rule from one time to another; where none holds it is kKeyed. The first link's turn is keyed, but for
// kContact and kHold.
struct PlaceInterval {
  double begin = 0, end = 0;  // s
  PlaceRule rule = PlaceRule::kPin;
  int link = 0;               // that is pinned; -1 with kGravity: whichever touches first
  Vec3 point = Vec3::Zero();  // m, of it, in its frame
  int other = -1;             // kFeet, kHold: the second foot, held at the same point of its frame; -1: none
};

// A clip: keys, what is dynamic, where the figure stands.
struct FigureClip {
  std::vector<JointTrack> tracks;  // at most one a link; a link without one stays at zero
  std::vector<DynamicInterval> dynamics;
  std::vector<PlaceInterval> places;
  std::vector<LinkCapsule> capsules;  // the figure's shape
  std::vector<Obstacle> obstacles;    // what it can touch
  double end = 1;                     // s; it begins at 0
};
// Throws Error, naming field and value, for what does not fit: two tracks of a link, links that do not exist,
// intervals that are empty, that lie outside 0 to `end`, or that claim a joint or the figure's place twice at
// a time. Quaternions become unit ones.
SOFTPOINT_API void check_clip(const FigureModel& model, FigureClip& clip);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

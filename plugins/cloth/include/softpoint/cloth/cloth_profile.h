#pragma once

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// What the last step of a cloth cost, did and skipped.
struct ClothProfile {
  // Wall seconds by stage.
  struct Seconds {
    double gather = 0;   // contact planes
    double bubbles = 0;  // which air is where; its leak and audit
    double solve = 0;    // small steps
    double self = 0;     // cloth on cloth
    double couple = 0;   // pushes on colliders, planes that move
  };
  struct Counts {
    int substeps = 0;
    int marched = 0;            // explicit steps that they were taken by; 0 where all were swept
    int march_refused = 0;      // small steps of explicit steps that were taken back and swept
    int planes = 0;             // contact planes at the start
    int queries = 0;            // nearest points asked of core
    int gathered_again = 0;     // times a point moved farther than foreseen
    int pockets = 0;            // with a pressure of their own
    bool air_skipped = false;   // dry or switched off: no search for bubbles
    int self_searches = 0;      // for near pairs
    int self_patches = 0;       // pairs of patches near each other
    int self_pairs = 0;         // pairs of points, edges and faces near each other
    int self_contacts = 0;      // corrections, summed over small steps
    int self_zones = 0;         // points that went together with others lest they pass through them, likewise
    int self_dropped = 0;       // pairs of faces left out: beyond what a frame may cost
    bool self_skipped = false;  // switched off, or nothing can have come near itself
  };
  Seconds seconds;
  Counts counts;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

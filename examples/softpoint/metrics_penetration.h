#pragma once

#include <string>

#include "player.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// The deepest point of a kind, 0 without any.
struct Depth {
  double depth = 0;  // m
  int frame = -1;
  std::string deformable, rigid;
  int point = -1;  // vertex of the deformable, or corner of the rigid solid

  void take(const Depth& other) {
    if (other.depth > depth) {
      *this = other;
    }
  }
};

struct Penetration {
  Depth vertex;  // vertices of deformables inside rigid shapes
  Depth corner;  // corners of rigid boxes, hulls and meshes inside the skin of deformables
};

// How deep bodies of a scene stand in each other now, by plain geometry: it shares nothing with the contact
// code, and looks at every vertex and every corner. Skins that are open have no inside.
Penetration measure_penetration(const Player& player);

// Depth of `point` below a closed surface (m), to its nearest triangle; 0 outside.
double depth_below_skin(const Surface& surface, const Vec3& point);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#pragma once

#include <cstdint>
#include <vector>

#include "mesh_store.h"
#include "view.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// One draw_mesh() call.
struct MeshDraw {
  int mesh = 0;
  bool two_sided = false, casts_shadow = true, wireframe = false;
  MeshInstance instance{};
  Box box;  // world
};

// Neighbouring instances of the same mesh, drawn by one call.
struct Run {
  int mesh = 0;
  bool two_sided = false;
  int first = 0, count = 0;  // instances
};

// The meshes of a frame, sorted so that equal ones can be drawn together.
class DrawList {
 public:
  void clear() { draws_.clear(); }
  void add(const MeshDraw& draw) { draws_.push_back(draw); }
  const std::vector<MeshDraw>& draws() const { return draws_; }

  void sort();
  // Appends the draws that `wanted(draw)` picks to `instances`, and their runs to `runs`.
  template <class Wanted>
  void gather(std::vector<MeshInstance>& instances, std::vector<Run>& runs, Wanted wanted) const {
    runs.clear();
    for (const std::uint32_t i : order_) {
      const MeshDraw& draw = draws_[i];
      if (!wanted(draw)) continue;
      if (runs.empty() || runs.back().mesh != draw.mesh || runs.back().two_sided != draw.two_sided) {
        runs.push_back({draw.mesh, draw.two_sided, static_cast<int>(instances.size()), 0});
      }
      ++runs.back().count;
      instances.push_back(draw.instance);
    }
  }

 private:
  std::vector<MeshDraw> draws_;
  std::vector<std::uint32_t> order_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

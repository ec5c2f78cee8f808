#pragma once

#include "softpoint/core/config.h"

// What the kernels of a sweep read and write. Plain data: see kernels.h for why.
namespace softpoint::inline SOFTPOINT_ABI::cloth {

inline constexpr int kTile = 16;         // slots of a tile: the most lanes of any instruction set
inline constexpr int kMaxRing = 24;      // neighbours of a point by springs
inline constexpr int kMaxBendRing = 40;  // by bending

// Points of one colour are neighbours in memory: `tiles` tiles of kTile slots from `first`. No spring, face
// or rim joins two of them.
struct ColourPlan {
  int first = 0;
  int tiles = 0;
  int ring = 0;   // neighbours of each slot, padded with stiffness 0
  int faces = 0;  // faces of each slot, padded with weight 0
  int bends = 0;  // neighbours by bending
  const int* offset =
      nullptr;  // [ring] slot of a neighbour less that of the point, the same for all; or null:
  const int* index = nullptr;           // [tile][ring][kTile] slot of the neighbour
  const int* bend_offset = nullptr;     // [bends], or null:
  const int* bend_index = nullptr;      // [tile][bends][kTile]
  const signed char* face_j = nullptr;  // [faces] the corners of each face after the point, within the ring
  const signed char* face_k = nullptr;
  long spring_at =
      0;  // of this colour within springs: [tile][ring][4][kTile] stiffness, rest, damper, damper * length
  long face_at = 0;  // within face_weight: [tile][faces][kTile]
  long bend_at = 0;  // within bend_weight: [tile][bends][kTile]
};

// Structure of arrays over the slots.
template <class T>
struct SweepData {
  T *x, *y, *z;           // the iterate, m
  T *lx, *ly, *lz;        // what its numbers have beyond those of T; in single only
  const T *tx, *ty, *tz;  // the way from the start on which inertia and constant forces alone bring it
  const T *sx, *sy, *sz;  // at the start of the small step
  const T *rx, *ry, *rz;  // what those numbers have beyond T; in single only
  const T* inertia;       // m (1 + r h)/h^2, N/m
  const T* free;          // 1, or 0 for what the sweep must not move
  T *gx, *gy, *gz;        // gradient of the energy without air, N
  T *ax, *ay, *az;        // H^-1 g
  T *vx, *vy, *vz;        // G = dV/dx, m2
  T *bx, *by, *bz;        // H^-1 G
  T *dx, *dy, *dz;        // the move
  T* h;                   // [6][slots] H: xx yy zz xy xz yz
  const T *ex, *ey, *ez;  // what rims add to G
  const T *nx, *ny, *nz, *level;  // contact plane at the end of the small step: n . x = level
  const T *ux, *uy, *uz;          // way of its surface within the small step, m
  const T *friction, *adhesion;
  T* touch;         // 0 apart, 1 sticks, 2 slides
  T* carried;       // 1 where a coarse correction carries the point along, else 0
  T *cx, *cy, *cz;  // contact force, N
  const T* springs;
  const T* face_weight;
  const T* bend_weight;
  const T* mass;
  const int* tile_pocket;  // -1 none, -2 several
  const int* slot_pocket;
  const signed char* tile_planes;  // whether any slot of the tile has a plane
  long slots;
  T compression;  // ratio
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

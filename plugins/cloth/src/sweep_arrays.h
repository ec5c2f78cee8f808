#pragma once

#include <cstdlib>
#include <memory>
#include <new>

#include "sweep_layout.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

struct FreeMemory {
  void operator()(void* p) const { std::free(p); }
};
template <class T>
using AlignedArray = std::unique_ptr<T[], FreeMemory>;

// Zeros, on the border of a cache line.
template <class T>
AlignedArray<T> aligned_zeros(long count) {
  const std::size_t bytes = (static_cast<std::size_t>(count) * sizeof(T) + 127) / 64 * 64;
  void* p = std::aligned_alloc(64, bytes);
  if (p == nullptr) throw std::bad_alloc();
  std::uninitialized_value_construct_n(static_cast<char*>(p), bytes);
  return AlignedArray<T>(static_cast<T*>(p));
}

// What SweepData points into: one block for all arrays over the slots, and those over springs, faces and
// bends.
template <class T>
struct SweepArrays {
  explicit SweepArrays(const SweepLayout& layout) : slots(layout.slots) {
    slot_block = aligned_zeros<T>(slots * kFields);
    springs = aligned_zeros<T>(layout.spring_size);
    face_weight = aligned_zeros<T>(static_cast<long>(layout.face_of.size()));
    bend_weight = aligned_zeros<T>(static_cast<long>(layout.bend_weight.size()));
    for (std::size_t i = 0; i < layout.bend_weight.size(); ++i)
      bend_weight[i] = static_cast<T>(layout.bend_weight[i]);
    tile_pocket = aligned_zeros<int>(slots / kTile + 1);
    slot_pocket = aligned_zeros<int>(slots);
    tile_planes = aligned_zeros<signed char>(slots / kTile + 1);
  }

  enum Field {
    kX,
    kT = 3,
    kS = 6,
    kW = 9,
    kG = 12,
    kA = 15,
    kV = 18,
    kB = 21,
    kD = 24,
    kE = 27,
    kN = 30,
    kU = 33,
    kC = 36,
    kF = 39,
    kH = 42,
    kM = 48,
    kLow = 51,
    kQ = 54,
    kR = 57,
    kL = 60,
    kStartLow = 63,
    kInertia = 66,
    kFree,
    kLevel,
    kFriction,
    kAdhesion,
    kTouch,
    kMass,
    kSecond,
    kCarried,
    kFields
  };
  T* field(int f) const { return slot_block.get() + f * slots; }

  SweepData<T> data(double compression) const {
    SweepData<T> d{};
    T** three[] = {&d.x, &d.lx, &d.gx, &d.ax, &d.vx, &d.bx, &d.dx, &d.cx};
    const int fields[] = {kX, kLow, kG, kA, kV, kB, kD, kC};
    for (int i = 0; i < 8; ++i) {
      for (int k = 0; k < 3; ++k) three[i][k] = field(fields[i] + k);
    }
    const T** more[] = {&d.tx, &d.sx, &d.rx, &d.ex, &d.nx, &d.ux};
    const int others[] = {kT, kS, kStartLow, kE, kN, kU};
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < 3; ++k) more[i][k] = field(others[i] + k);
    }
    d.h = field(kH);
    d.inertia = field(kInertia), d.free = field(kFree), d.level = field(kLevel),
    d.friction = field(kFriction);
    d.adhesion = field(kAdhesion), d.touch = field(kTouch), d.carried = field(kCarried),
    d.mass = field(kMass);
    d.springs = springs.get(), d.face_weight = face_weight.get(), d.bend_weight = bend_weight.get();
    d.tile_pocket = tile_pocket.get(), d.slot_pocket = slot_pocket.get(), d.tile_planes = tile_planes.get();
    d.slots = slots;
    d.compression = static_cast<T>(compression);
    return d;
  }

  long slots;
  AlignedArray<T> slot_block, springs, face_weight, bend_weight;
  AlignedArray<int> tile_pocket, slot_pocket;
  AlignedArray<signed char> tile_planes;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

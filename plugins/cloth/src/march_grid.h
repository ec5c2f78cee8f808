#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "march_kernels.h"
#include "softpoint/cloth/pattern.h"
#include "sweep_arrays.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Memory of the explicit steps and where points, springs and faces of a pattern lie in it.
template <class T>
class MarchGrid {
 public:
  using Data = MarchData<T>;
  using Place = typename Data::Place;
  struct Spot {
    int array;  // family of springs or kind of face, -1 for none
    long at;
  };

  // For kernels of vectors of `bytes`.
  MarchGrid(const ClothPattern& pattern, int bytes) : lanes_(bytes / static_cast<int>(sizeof(T))) {
    usable_ = pattern.columns >= 2 && pattern.rows >= 2 && pattern.bends.empty() &&
              pattern.columns * pattern.rows == pattern.point_count() && place(pattern);
    if (usable_) allocate();
  }

  // Whether the pattern is a plain grid: springs to eight neighbours, equally long in each family, no
  // bending.
  bool usable() const { return usable_; }
  double area() const { return area_; }  // m2, at rest
  long at(int point) const { return point / data_.columns * data_.stride + point % data_.columns; }
  const std::vector<Spot>& springs() const { return springs_; }
  const std::vector<Spot>& faces() const { return faces_; }

  const Data& data() const { return data_; }
  Data& data() { return data_; }
  // Springs and faces by the unit of places, of which kernels count.
  void set_unit(T unit) {
    data_.unit = unit, data_.per_unit = 1 / unit;
    for (int f = 0; f < Data::kFamilies; ++f) data_.rest[f] = static_cast<T>(rest_[f] / unit);
  }
  // To be called when what the kernels only read has changed.
  void compare_rows() {
    data_.points_alike = alike(mass) && alike(inverse_mass) && alike(friction) && alike(adhesion);
    data_.springs_alike = true;
    for (int k = 0; k < 3; ++k) {
      data_.points_alike = data_.points_alike && alike(acceleration[k]) && alike(normal[k]) && alike(foot[k]);
    }
    for (const T* of_family : data_.stiffness) data_.springs_alike = data_.springs_alike && alike(of_family);
  }
  // What the kernels only read.
  T *mass = nullptr, *inverse_mass = nullptr, *friction = nullptr, *adhesion = nullptr;
  T *acceleration[3], *stiffness[4], *normal[3], *faces_weight[4], *rim[3];
  Place* foot[3];

 private:
  template <class N>
  bool alike(const N* field) const {
    const N* first = field + data_.stride;
    for (long row = 2; row + 1 < data_.rows; ++row) {
      if (!std::equal(first, first + data_.stride, field + row * data_.stride)) return false;
    }
    return true;
  }
  static double face_area(const ClothPattern& pattern, const Triangle& face) {
    const Vec3 a = pattern.points[face[1]] - pattern.points[face[0]];
    const Vec3 b = pattern.points[face[2]] - pattern.points[face[0]];
    return std::sqrt(std::max(0.0, a.squaredNorm() * b.squaredNorm() - a.dot(b) * a.dot(b))) / 2;
  }

  bool place(const ClothPattern& pattern) {
    data_.columns = pattern.columns, data_.rows = pattern.rows;
    data_.stride = data_.columns / lanes_ * lanes_ + lanes_;
    data_.turned_stride = (data_.rows + lanes_ - 1) / lanes_ * lanes_;
    const auto column = [&](int p) { return p % pattern.columns; };
    const auto row = [&](int p) { return p / pattern.columns; };
    for (const Spring& spring : pattern.springs) {
      const int dx = column(spring.b) - column(spring.a), dy = row(spring.b) - row(spring.a);
      const int family = dy == 0 && dx == 1    ? 0
                         : dy == 1 && dx == 0  ? 1
                         : dy == 1 && dx == 1  ? 2
                         : dy == 1 && dx == -1 ? 3
                                               : -1;
      if (family < 0) return false;
      if (rest_[family] == 0) rest_[family] = spring.rest;
      if (std::abs(spring.rest - rest_[family]) > 1e-9 * rest_[family]) return false;
      springs_.push_back({family, at(spring.a)});
    }
    for (double& rest : rest_) rest = rest > 0 ? rest : 1;
    set_unit(T(1));
    for (const Triangle& face : pattern.faces) {
      int left = face[0], low = face[0];
      for (int p : face) {
        left = column(p) < column(left) ? p : left;
        low = row(p) < row(low) ? p : low;
      }
      const int a = row(low) * pattern.columns + column(left);
      const int corners[4] = {a, a + 1, a + pattern.columns + 1, a + pattern.columns};
      constexpr int kKinds[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 1, 3}, {1, 2, 3}};
      Spot spot{-1, at(a)};
      for (int kind = 0; kind < 4; ++kind) {
        for (int turn = 0; turn < 3; ++turn) {
          bool same = true;
          for (int k = 0; k < 3; ++k) same = same && face[k] == corners[kKinds[kind][(k + turn) % 3]];
          if (same) spot.array = kind;
        }
      }
      if (spot.array < 0) return false;
      data_.crossed = data_.crossed || spot.array >= 2;
      faces_.push_back(spot);
      area_ += face_area(pattern, face);
    }
    return true;
  }

  void allocate() {
    const long more = 4 + kMarchLanes;  // rows of zeros, for those that are turned together
    const long size = (data_.rows + more) * data_.stride,
               turned = (data_.columns + more) * data_.turned_stride;
    const long scratch = 2 * Data::kRowArrays * (data_.stride + Data::kPadding) + 64;
    constexpr long kFields = 48, kTurned = 9;
    block_ = aligned_zeros<T>(kFields * size + kTurned * turned + scratch);
    places_ = aligned_zeros<Place>(6 * size);
    T* next = block_.get() + 2 * data_.stride;
    const auto field = [&] {
      T* out = next;
      next += size;
      return out;
    };
    for (int k = 0; k < 3; ++k) {
      data_.x[k] = places_.get() + 2 * data_.stride + k * size;
      data_.foot[k] = foot[k] = places_.get() + 2 * data_.stride + (3 + k) * size;
      data_.v[k] = field(), data_.f[k] = field(), data_.g[k] = field(), data_.c[k] = field();
      data_.acceleration[k] = acceleration[k] = field(), data_.normal[k] = normal[k] = field();
      data_.rim[k] = rim[k] = field(), data_.lower[k] = field(), data_.pivot[k] = field();
      data_.cells[k] = field();
    }
    for (int f = 0; f < 4; ++f) {
      data_.stiffness[f] = stiffness[f] = field(), data_.faces[f] = faces_weight[f] = field();
      data_.length[f] = field();
    }
    data_.touch = field(), data_.mass = mass = field(), data_.inverse_mass = inverse_mass = field();
    data_.friction = friction = field(), data_.adhesion = adhesion = field();
    next -= 2 * data_.stride;
    for (int k = 0; k < 3; ++k) {
      data_.turned[k] = next, data_.turned_lower[k] = next + turned,
      data_.turned_pivot[k] = next + 2 * turned;
      next += 3 * turned;
    }
    data_.scratch = next;
  }

  int lanes_;
  bool usable_ = false;
  double rest_[4] = {0, 0, 0, 0};  // m
  double area_ = 0;
  Data data_{};
  std::vector<Spot> springs_, faces_;
  AlignedArray<T> block_;
  AlignedArray<Place> places_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

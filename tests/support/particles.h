#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "softpoint/core/deformable.h"

namespace softpoint {

// The simplest deformable: its points are free particles. For tests of the seam without a plugin.
class Particles final : public Deformable {
 public:
  Particles(std::vector<Vec3> points, std::vector<Triangle> triangles, double mass)
      : Deformable(points, std::move(triangles), std::vector<double>(points.size(), mass)) {}

  // Four particles of 1 kg, a tetrahedron of edge length near `size` about `center`.
  static Particles tetrahedron(const Vec3& center, double size = 0.3) {
    const double a = 0.5 * size;
    return {{center + Vec3(-a, -a, -a), center + Vec3(a, -a, -a), center + Vec3(0, -a, a),
             center + Vec3(0, a, 0)},
            {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}},
            1.0};
  }

  double elastic_energy() const override { return 0; }

  // The next predict() leaves these many points not a number.
  int poison = 0;
  int restored_calls = 0;

 private:
  void predict(double dt) override {
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      end_positions_[v] = positions_[v] + dt * velocities_[v];
    }
    for (; poison > 0; --poison) {
      end_positions_[static_cast<std::size_t>(poison - 1)].setConstant(
          std::numeric_limits<double>::quiet_NaN());
    }
  }
  void compliance(std::span<const int> touched, double* blocks) override {
    const std::size_t n = 3 * touched.size();
    std::fill(blocks, blocks + n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      blocks[i * n + i] = 1.0 / masses_[static_cast<std::size_t>(touched[i / 3])];
    }
  }
  void respond(std::span<const int> touched, std::span<const Vec3> impulses) override {
    end_positions_ = free_positions_;
    for (std::size_t i = 0; i < touched.size(); ++i) {
      const auto v = static_cast<std::size_t>(touched[i]);
      end_positions_[v] += step_ * impulses[i] / masses_[v];
    }
  }
  void commit(double dt) override { Deformable::commit(dt); }
  void restored() override { ++restored_calls; }

 public:
  double step_ = 1.0 / 60.0;  // s, of the tests that use it
};

}  // namespace softpoint

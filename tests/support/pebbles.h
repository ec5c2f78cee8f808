#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "softpoint/core/deformable.h"
#include "softpoint/core/near_colliders.h"

namespace softpoint {

// A deformable that solves its own contact in the simplest way: free points that stop dead, without
// friction, where they meet a collider; in parts of a step. For tests of that seam without a plugin.
class Pebbles final : public Deformable {
 public:
  Pebbles(std::vector<Vec3> points, std::vector<Triangle> triangles, double mass)
      : Deformable(points, std::move(triangles), std::vector<double>(points.size(), mass)) {}

  // n x n points in a horizontal square of this side about `center`.
  static Pebbles square(const Vec3& center, int n, double side, double mass) {
    std::vector<Vec3> points;
    std::vector<Triangle> faces;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        points.push_back(center + side * Vec3(double(i) / (n - 1) - 0.5, 0, 0.5 - double(j) / (n - 1)));
        if (i > 0 && j > 0) {
          const int d = j * n + i, c = d - 1, b = d - n, a = b - 1;
          faces.push_back({a, b, c});
          faces.push_back({b, d, c});
        }
      }
    }
    return {points, faces, mass};
  }

  double elastic_energy() const override { return 0; }
  void set_velocity(const Vec3& v) {
    std::fill(velocities_.begin(), velocities_.end(), v);
    wake();
  }

  int parts = 8;
  long long steps = 0;
  int pieces = 0;  // near in the last step

 private:
  bool solves_contact() const override { return true; }
  std::string_view kind() const override { return "pebbles"; }

  void advance_by(double dt, const Vec3& acceleration, NearColliders& near,
                  std::span<HeldPoint> held) override {
    ++steps;
    pieces = near.pieces();
    moving_ = velocities_;
    end_positions_ = positions_;
    const double h = dt / parts;
    for (int part = 1; part <= parts; ++part) {
      near.begin(h);
      for (std::size_t v = 0; v < moving_.size(); ++v) {
        moving_[v] += h * acceleration;
      }
      for (int sweep = 0; sweep < 50; ++sweep) {  // several may hold one point
        for (HeldPoint& hold : held) {
          if (sweep == 0 || std::isinf(hold.max_force)) {
            pull(hold, h, part, near);
          }
        }
      }
      for (int k = 0; k < near.pieces(); ++k) {
        for (std::size_t v = 0; v < moving_.size(); ++v) {
          stop(v, k, h, near);
        }
      }
      for (std::size_t v = 0; v < moving_.size(); ++v) {
        end_positions_[v] += h * moving_[v];
      }
      near.advance(h);
    }
  }

  void pull(HeldPoint& hold, double h, int part, NearColliders& near) {
    const auto v = static_cast<std::size_t>(hold.point);
    Vec3 aim = hold.target;
    if (hold.collider >= 0) {
      const Vec3 now = near.to_world(hold.collider, hold.target);
      aim = now + h * near.velocity_at(hold.collider, now);
    } else {
      aim = end_positions_[v] + (hold.target - end_positions_[v]) / (parts - part + 1);
    }
    double inverse = 1.0 / masses_[v];
    if (hold.collider >= 0) {
      double block[36];
      near.mobility(hold.collider, block);
      inverse += block[0];
    }
    Vec3 impulse = ((aim - end_positions_[v]) / h - moving_[v]) / inverse;
    impulse *= std::min(1.0, hold.max_force * h / std::max(impulse.norm(), 1e-30));
    moving_[v] += impulse / masses_[v];
    hold.impulse += impulse;
    if (hold.collider >= 0) {
      near.push(hold.collider, -impulse, end_positions_[v]);
    }
  }

  void stop(std::size_t v, int piece, double h, NearColliders& near) {
    NearSurface surface;
    signed char side = 1;
    if (!near.nearest(piece, end_positions_[v], 0.1, side, surface)) {
      return;
    }
    const int collider = near.piece(piece).collider;
    const Vec3 foot = end_positions_[v] - surface.gap * surface.normal;
    const double closing =
        surface.normal.dot(moving_[v] - near.velocity_at(collider, foot)) + surface.gap / h;
    if (closing >= 0.0) {
      return;
    }
    double block[36];
    near.mobility(collider, block);
    const Vec3 arm = foot - near.center(collider);
    const Vec3 turning = arm.cross(surface.normal);
    const Vec3 spin =
        Eigen::Map<const Eigen::Matrix<double, 6, 6>>(block).bottomRightCorner<3, 3>() * turning;
    const double inverse = 1.0 / masses_[v] + block[0] + turning.dot(spin);
    const Vec3 impulse = -closing / inverse * surface.normal;
    moving_[v] += impulse / masses_[v];
    near.push(collider, -impulse, foot);
  }

  void commit(double) override {
    positions_ = end_positions_;
    velocities_ = moving_;
  }

  std::vector<Vec3> moving_;  // m/s, velocities in the step
};

}  // namespace softpoint

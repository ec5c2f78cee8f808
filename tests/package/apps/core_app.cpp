// A plugin of the application's own on the seam to Bullet: four free particles that fall on a floor.
#include <algorithm>
#include <cmath>

#include "app.h"
#include "softpoint/core/deformable_system.h"
#include "softpoint/core/shapes.h"

namespace {

using softpoint::Vec3;

class Particles final : public softpoint::Deformable {
 public:
  explicit Particles(double height)
      : Deformable({{0, height, 0}, {0.2, height, 0}, {0, height, 0.2}, {0, height + 0.2, 0}},
                   {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}, {1, 1, 1, 1}) {}
  double elastic_energy() const override { return 0; }

 private:
  void predict(double dt) override {
    dt_ = dt;
    for (std::size_t v = 0; v < 4; ++v) end_positions_[v] = positions_[v] + dt * velocities_[v];
  }
  void compliance(std::span<const int> touched, double* blocks) override {
    const std::size_t n = 3 * touched.size();
    std::fill(blocks, blocks + n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) blocks[i * n + i] = 1.0;
  }
  void respond(std::span<const int> touched, std::span<const Vec3> impulses) override {
    end_positions_ = free_positions_;
    for (std::size_t i = 0; i < touched.size(); ++i) {
      end_positions_[static_cast<std::size_t>(touched[i])] += dt_ * impulses[i];
    }
  }
  double dt_ = 0;
};

}  // namespace

int main() {
  World scene;
  softpoint::DeformableSystem soft(scene.world);
  Particles body(1.0);
  soft.add(body);

  scene.step(20);
  // Symplectic Euler: n (n + 1) / 2 steps of g dt^2.
  const double fallen = 9.81 * 20 * 21 / 2 / 3600;
  std::printf("height after 20 steps: %.9f m\n", body.points()[0].y());
  require(std::abs(body.points()[0].y() - (1.0 - fallen)) < 1e-5, "free fall");
  scene.step(60);
  std::printf("height after 80 steps: %.9f m\n", body.points()[0].y());
  require(std::abs(body.points()[0].y() - soft.settings().margin) < 1e-4, "rest on the floor");

  // The second base of a class from the library, met through Bullet's pointer.
  btCollisionObject* object = &body;
  require(dynamic_cast<softpoint::Surface*>(object) != nullptr, "a deformable is a Surface");
  object = &scene.floor;
  require(dynamic_cast<softpoint::Surface*>(object) == nullptr, "the floor is none");

  require_refusal([] { softpoint::sphere(-1.0); }, "radius");
  require_refusal([&] { body.apply_impulse(9, {1, 0, 0}, {0, 1, 0}); }, "face");
}

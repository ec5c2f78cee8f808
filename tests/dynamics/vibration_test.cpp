// A free bar, stretched and let go, rings at the frequency of theory; implicit Euler damps it in proportion
// to the step, so frequency and decay approach theory with order 1.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/precision.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

struct Ringing {
  double frequency = 0;  // Hz
  double damping = 0;    // 1/s, of the amplitude
};

// Rings the first lengthwise mode by impulses that pull the ends apart.
Ringing ring(double dt) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::bar, 1e5, dt, 1000.0, 0.0), Vec3::Zero());
  system.add(body);
  // Velocities of the mode shape sin(pi x / L), put in by impulses on the faces.
  for (int f = 0; f < static_cast<int>(body.faces().size()); ++f) {
    const Triangle& t = body.faces()[static_cast<std::size_t>(f)];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(t[k]);
      int shared = 0;
      for (const Triangle& other : body.faces()) {
        for (const int w : other) shared += w == t[k];
      }
      const double speed = 0.05 * std::sin(std::numbers::pi * body.points()[v].x());
      Vec3 weights = Vec3::Zero();
      weights[static_cast<Eigen::Index>(k)] = 1;
      body.apply_impulse(f, weights, Vec3(body.masses()[v] * speed / shared, 0, 0));
    }
  }
  // Length of the bar over time, seen as the mean of the end points.
  const auto stretch = [&] {
    double sum = 0, mass = 0;
    for (std::size_t v = 0; v < body.points().size(); ++v) {
      const double x = body.model().rest[v].x();
      if (std::abs(x) > 0.49) {
        sum += body.masses()[v] * (body.points()[v].x() - x) * (x > 0 ? 1 : -1);
        mass += body.masses()[v];
      }
    }
    return sum / mass;
  };
  std::vector<double> crossings, peaks;
  double last = 0, peak = 0;
  const int steps = static_cast<int>(1.1 / dt);
  for (int i = 1; i <= steps; ++i) {
    world.step(1, dt);
    const double now = stretch();
    peak = std::max(peak, std::abs(now));
    if (last * now < 0) {
      crossings.push_back((i - now / (now - last)) * dt);
      peaks.push_back(peak);
      peak = 0;
    }
    last = now;
  }
  Ringing result;
  const auto count = static_cast<double>(crossings.size() - 1);
  result.frequency = 0.5 * count / (crossings.back() - crossings.front());
  result.damping = std::log(peaks[1] / peaks.back()) / (crossings.back() - crossings[1]);
  return result;
}

TEST(Vibration, OfABarMatchesTheory) {
  // Wave speed sqrt(E / rho) = 10 m/s over 1 m, free ends: 5 Hz. The mass sits on the surface, which for a
  // square section changes nothing lengthwise but on the end faces (2 * 0.04 of 0.88 m2 of area): the first
  // mode of a bar with its mass at the ends raised obeys tan(k L / 2) = 1 / (k m_end / rho_line) below.
  const double area_side = 0.8, area_end = 0.04, total = area_side + 2 * area_end;
  const double line = 40.0 * area_side / total, end = 40.0 * area_end / total;  // kg/m, kg
  double low = 2.0, high = 3.14159;                                             // of k L
  for (int i = 0; i < 60; ++i) {
    const double k = 0.5 * (low + high);
    // Free ends with point mass: E A k cos(k/2) = end w^2 sin(k/2), w^2 = E A k^2 / line.
    (std::cos(0.5 * k) - end * k / line * std::sin(0.5 * k) > 0 ? low : high) = k;
  }
  const double theory = low * std::sqrt(1e5 * 0.04 / line) / (2 * std::numbers::pi);
  const double w = 2 * std::numbers::pi * theory;
  std::vector<double> errors, ratios;
  for (const double dt : {1.0 / 240, 1.0 / 480, 1.0 / 960}) {
    const Ringing r = ring(dt);
    // Implicit Euler: amplitude falls by 1 / sqrt(1 + (w h)^2) a step, rate w^2 h / 2 to first order.
    const double expected = 0.5 * std::log1p(w * w * dt * dt) / dt;
    std::printf("    dt 1/%-4.0f: %.4f Hz (theory %.4f), damping %.3f /s (implicit Euler %.3f)\n", 1 / dt,
                r.frequency, theory, r.damping, expected);
    errors.push_back(std::abs(r.damping));
    ratios.push_back(r.damping / expected);
    // Mass lumped on the vertices of ten cells lowers the frequency by some per cent.
    EXPECT_NEAR(r.frequency / theory, 1.0, 0.03) << "dt " << dt;
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 1.0, 0.15);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 1.0, 0.15);
  EXPECT_NEAR(ratios.back(), 1.0, 0.1);
}

}  // namespace
}  // namespace softpoint

#include "benchmarks/bar_task.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/exact_beam.h"
#include "support/whole_bar_reference.h"

namespace softpoint::benchmarks {
namespace {

using reference::Beam;
using reference::BeamPoint;

// The push bends the bar beyond the piece that the clamp keeps straight.
Beam pushed_beam(int parts) {
  return reference::prism_beam(reference::kSides, reference::kRadius,
                               parts * reference::kPartLength - reference::bend_clamp(), kYoung, kPoisson);
}

// A cross-section's centre, turn about y and curvature.
struct Section {
  double x = 0, z = 0, theta = 0, curvature = 0;
};

// Bent between two plates by a moment alone: straight pieces at both, an arc between. `s` from the bottom.
Section on_arc(const BarTask& task, double angle, double s) {
  const double clamp = reference::bend_clamp(), arc = task.length() - 2.0 * clamp;
  const double phi = angle * std::clamp((s - clamp) / arc, 0.0, 1.0);
  const double after = std::max(s - clamp - arc, 0.0), before = std::min(s, clamp);
  Section c = {after * std::sin(phi), before + after * std::cos(phi), phi, 0.0};
  if (angle == 0.0) {
    c.z = s;
    return c;
  }
  const double radius = arc / angle;
  c.x += radius * (1.0 - std::cos(phi));
  c.z += radius * std::sin(phi);
  if (s > clamp && after == 0.0) c.curvature = 1.0 / radius;
  return c;
}

Section on_line(const std::vector<BeamPoint>& line, const Beam& beam, double s) {
  const double clamp = reference::bend_clamp();
  if (s < clamp) return {0.0, s, 0.0, 0.0};
  const double at = (s - clamp) / beam.length * static_cast<double>(line.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), line.size() - 2);
  const double t = at - static_cast<double>(i);
  const auto mix = [t](double a, double b) { return (1.0 - t) * a + t * b; };
  const BeamPoint &a = line[i], &b = line[i + 1];
  return {mix(a.x, b.x), clamp + mix(a.z, b.z), mix(a.theta, b.theta),
          mix(a.moment, b.moment) / beam.bending};
}

// Sections stay plane and are narrowed by Poisson's ratio as in pure bending.
Vec3 in_section(const Section& c, const BarTask& task, const Vec3& rest) {
  // Positive curvature shortens the side of positive x.
  const double x = rest.x(), y = rest.y();
  const Vec3 local(x + 0.5 * kPoisson * c.curvature * (x * x - y * y), y + kPoisson * c.curvature * x * y,
                   0.0);
  return Vec3(c.x, 0.0, c.z - 0.5 * task.length()) + Eigen::AngleAxisd(c.theta, Vec3::UnitY()) * local;
}

bool is_free(const BarTask& task, const Vec3& rest) {
  return std::abs(std::abs(rest.z()) - 0.5 * task.length()) > 1e-9;
}

}  // namespace

EndPose BarTask::pose(double load) const {
  if (motion == Motion::kStretch) return {Vec3(0.0, 0.0, load * amount), 0.0, 0.0};
  if (motion == Motion::kTwist) return {Vec3::Zero(), 0.0, load * amount};
  const Section end = on_arc(*this, load * amount, length());
  return {Vec3(end.x, 0.0, end.z - length()), end.theta, 0.0};
}

std::vector<BarTask> all_tasks(int parts) {
  const double length = parts * reference::kPartLength, angle = 0.5 * std::numbers::pi * parts / 13.0;
  const Beam beam = pushed_beam(parts);
  return {{Motion::kStretch, "stretch", parts, 0.1 * length},
          {Motion::kBend, "bend", parts, angle},
          {Motion::kTwist, "twist", parts, angle},
          {Motion::kPush, "push", parts, reference::force_for_deflection(beam, 0.5 * length / beam.length)}};
}

BarAnswer reference_answer(const BarTask& task) {
  BarAnswer answer;
  const TriangleMesh mesh = reference::bar_mesh(task.parts);
  const reference::BarStiffness stiffness = reference::whole_bar_stiffness(task.parts);
  const double half = 0.5 * task.length();
  switch (task.motion) {
    case Motion::kStretch:
      answer.force = kYoung * stiffness.stretch * task.amount;
      for (const Vec3& x : mesh.vertices) {
        const auto [narrowing, shift] = reference::stretched(task.parts, half - std::abs(x.z()));
        const double radial = 1.0 + narrowing * task.amount / reference::kRadius;
        // The bottom stays, so the middle moves by half of it.
        const double along = task.amount * (0.5 + (x.z() < 0.0 ? -shift : shift));
        answer.vertices.emplace_back(radial * x.x(), radial * x.y(), x.z() + along);
      }
      break;
    case Motion::kTwist:
      answer.force = kYoung * stiffness.twist * task.amount;
      for (const Vec3& x : mesh.vertices) {
        answer.vertices.push_back(Eigen::AngleAxisd(task.amount * (0.5 + 0.5 * x.z() / half), Vec3::UnitZ()) *
                                  x);
      }
      break;
    case Motion::kBend:
      answer.force = kYoung * stiffness.bend * task.amount;
      for (const Vec3& x : mesh.vertices) {
        answer.vertices.push_back(in_section(on_arc(task, task.amount, x.z() + half), task, x));
      }
      break;
    case Motion::kPush: {
      const Beam beam = pushed_beam(task.parts);
      const std::vector<BeamPoint> line = reference::solve_beam(beam, {task.amount, 0.0, 0.0});
      for (const Vec3& x : mesh.vertices) {
        answer.vertices.push_back(in_section(on_line(line, beam, x.z() + half), task, x));
      }
      break;
    }
  }
  answer.tip = answer.vertices.back();
  return answer;
}

double position_error(const BarTask& task, const std::vector<Vec3>& x, const std::vector<Vec3>& answer) {
  const std::vector<Vec3> rest = reference::bar_mesh(task.parts).vertices;
  double wrong = 0.0, moved = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_free(task, rest[i])) continue;
    wrong += (x[i] - answer[i]).squaredNorm();
    moved += (answer[i] - rest[i]).squaredNorm();
  }
  return std::sqrt(wrong / moved);
}

double end_load(const BarTask& task, const Bar& bar) {
  const auto force = bar.end_force(), moment = bar.end_moment();
  if (!task.is_held() || !force || !moment) return std::numeric_limits<double>::quiet_NaN();
  if (task.motion == Motion::kStretch) return force->z();
  return task.motion == Motion::kTwist ? moment->z() : moment->y();
}

double end_error(const BarTask& task, const Bar& bar, const BarAnswer& answer) {
  if (!task.is_held()) return (bar.vertices().back() - answer.tip).norm() / task.length();
  return std::abs(end_load(task, bar) / answer.force - 1.0);
}

}  // namespace softpoint::benchmarks

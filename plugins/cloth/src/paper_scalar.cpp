#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

#include "paper_spheres.h"
#include "paper_stepper.h"

// The thesis as written, one loop a formula. Equation numbers are its own.
namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

class PaperScalar final : public PaperStepper {
 public:
  explicit PaperScalar(const PaperModel& model)
      : pattern_(model.pattern),
        settings_(model.settings),
        compression_ratio_(model.fabric.compression_ratio),
        damping_time_(model.fabric.damping_time),
        drag_rate_(model.fabric.drag_rate),
        position_(pattern_.points),
        velocity_(pattern_.points.size(), Vec3::Zero()),
        spring_force_(velocity_),
        air_area_(velocity_),
        spheres_(pattern_.columns, pattern_.rows, settings_.sphere_diameter, settings_.sphere_friction) {
    double area = 0;
    for (const Triangle& t : pattern_.faces) {
      const Vec3 &a = pattern_.points[t[0]], &b = pattern_.points[t[1]], &c = pattern_.points[t[2]];
      area += 0.5 * (b - a).cross(c - a).norm();
    }
    area_of_point_ = area / pattern_.point_count();
  }

  void set_point(int point, const Vec3& position, const Vec3& velocity) override {
    position_[point] = position;
    velocity_[point] = velocity;
  }
  Vec3 position(int point) const override { return position_[point]; }
  Vec3 velocity(int point) const override { return velocity_[point]; }
  void set_velocity(int point, const Vec3& velocity) override { velocity_[point] = velocity; }

  double forces() override {
    spring_forces();
    return settings_.pressure == PaperPressure::kConstantArea ? point_normals() : volume_gradient();
  }

  // v is (P_t - P_t-1)/h, so that P_t + h v of move() is (3.1).
  void accelerate(double h, double gauge, const Vec3& gravity) override {
    for (std::size_t i = 0; i < position_.size(); ++i) {
      const double m = pattern_.masses[i];
      const Vec3 force =
          m * gravity + spring_force_[i] + gauge * air_area_[i] - m * drag_rate_ * velocity_[i];
      velocity_[i] += h / m * force;
    }
  }

  void collide(double h) override {
    if (spheres_.wanted()) spheres_.collide(*this, h);
  }

  void move(double h, double gauge, const Vec3& gravity, double friction) override {
    for (std::size_t i = 0; i < position_.size(); ++i) {
      Vec3& v = velocity_[i];
      const double push = -position_[i].z() / h - v.z();  // speed that keeps the point out of the plane
      if (push > 0) {
        double limit = friction * push;
        if (settings_.friction == PaperFriction::kForces) {  // (3.4), (3.5)
          const double pressed =
              -gravity.z() - (spring_force_[i].z() + gauge * air_area_[i].z()) / pattern_.masses[i];
          limit = friction * std::max(0.0, pressed) * h;
        }
        const double slip = std::hypot(v.x(), v.y());
        const double kept = slip > limit ? 1 - limit / slip : 0.0;
        v = {kept * v.x(), kept * v.y(), v.z() + push};
      }
      position_[i] += h * v;
    }
  }

 private:
  // (3.6), with a compression ratio and dampers along the springs; both are switched off by 1 and 0.
  void spring_forces() {
    std::fill(spring_force_.begin(), spring_force_.end(), Vec3::Zero());
    for (const Spring& s : pattern_.springs) {
      const Vec3 arm = position_[s.b] - position_[s.a];
      const double length = arm.norm();
      const Vec3 direction = arm / length;
      const double stretch = length - s.rest;
      const double k = stretch < 0 ? s.stiffness * compression_ratio_ : s.stiffness;
      const double rate = direction.dot(velocity_[s.b] - velocity_[s.a]);
      const Vec3 force = (k * stretch + damping_time_ * s.stiffness * rate) * direction;
      spring_force_[s.a] += force;
      spring_force_[s.b] -= force;
    }
  }

  // S N of (3.7), N pointing out of the bubble: the sign that makes suction pull towards the plane.
  double point_normals() {
    std::fill(air_area_.begin(), air_area_.end(), Vec3::Zero());
    double volume = 0;
    for (const Triangle& t : pattern_.faces) {
      const Vec3 &a = position_[t[0]], &b = position_[t[1]], &c = position_[t[2]];
      const Vec3 twice_area = (b - a).cross(c - a);
      for (int point : t) air_area_[point] += twice_area;
      volume += 0.5 * twice_area.z() * (a.z() + b.z() + c.z()) / 3;  // (3.10)
    }
    for (Vec3& n : air_area_) n *= area_of_point_ / std::max(n.norm(), 1e-300);
    return volume;
  }

  // (3.10) and its derivatives by the coordinates of the corners.
  double volume_gradient() {
    std::fill(air_area_.begin(), air_area_.end(), Vec3::Zero());
    double volume = 0;
    for (const Triangle& t : pattern_.faces) {
      const Vec3 &a = position_[t[0]], &b = position_[t[1]], &c = position_[t[2]];
      const double shadow = 0.5 * (b - a).cross(c - a).z(), height = (a.z() + b.z() + c.z()) / 3;
      volume += shadow * height;
      air_area_[t[0]] += Vec3(0.5 * height * (b.y() - c.y()), 0.5 * height * (c.x() - b.x()), shadow / 3);
      air_area_[t[1]] += Vec3(0.5 * height * (c.y() - a.y()), 0.5 * height * (a.x() - c.x()), shadow / 3);
      air_area_[t[2]] += Vec3(0.5 * height * (a.y() - b.y()), 0.5 * height * (b.x() - a.x()), shadow / 3);
    }
    return volume;
  }

  const ClothPattern& pattern_;
  PaperSettings settings_;
  double compression_ratio_, damping_time_, drag_rate_, area_of_point_ = 0;
  std::vector<Vec3> position_, velocity_, spring_force_, air_area_;
  PaperSpheres spheres_;
};

}  // namespace

std::unique_ptr<PaperStepper> make_scalar_paper_stepper(const PaperModel& model) {
  return std::make_unique<PaperScalar>(model);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

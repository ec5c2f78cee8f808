#pragma once

#include <memory>
#include <span>
#include <vector>

#include "softpoint/cloth/paper_settings.h"
#include "softpoint/cloth/pattern.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// What both forms of the `paper` mode are told at the start. Frame: the plane is z = 0, the cloth above it.
struct PaperModel {
  const ClothPattern& pattern;  // a grid
  const Fabric& fabric;
  PaperSettings settings;
};

// The stages of one explicit step.
class PaperStepper {
 public:
  virtual ~PaperStepper() = default;
  virtual void set_point(int point, const Vec3& position, const Vec3& velocity) = 0;
  virtual Vec3 position(int point) const = 0;
  virtual Vec3 velocity(int point) const = 0;
  virtual void set_velocity(int point, const Vec3& velocity) = 0;
  // Spring forces and the direction of the air's; returns the volume (3.10) under the cloth, m3.
  virtual double forces() = 0;
  // Velocities at the end of the step without contact; `gauge` is the bubble's pressure less the ambient one,
  // Pa.
  virtual void accelerate(double h, double gauge, const Vec3& gravity) = 0;
  // Spheres of the points push each other apart.
  virtual void collide(double h) = 0;
  // Contact with the plane, and the move.
  virtual void move(double h, double gauge, const Vec3& gravity, double friction) = 0;
};

std::unique_ptr<PaperStepper> make_scalar_paper_stepper(const PaperModel& model);
std::unique_ptr<PaperStepper> make_simd_paper_stepper(const PaperModel& model);

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

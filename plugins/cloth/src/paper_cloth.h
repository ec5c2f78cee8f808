#pragma once

#include <memory>
#include <span>
#include <vector>

#include "paper_stepper.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Moves one point where the user wants it, whatever it takes. Its way within a frame is a cubic.
struct PaperHand {
  int point = -1;
  Vec3 target = Vec3::Zero();    // m, at the end of the frame
  Vec3 velocity = Vec3::Zero();  // m/s, at the end of the frame
};

// The `paper` mode: a grid over one plane, z = 0 unless told, with one bubble under it. SI.
class PaperCloth {
 public:
  // Flat in the pattern's place, at rest. Throws Error when the pattern is no grid with equal springs a
  // family.
  PaperCloth(ClothPattern pattern, const Fabric& fabric, const PaperSettings& settings);

  int point_count() const { return pattern_.point_count(); }
  const ClothPattern& pattern() const { return pattern_; }
  const PaperSettings& settings() const { return settings_; }
  void set_state(std::span<const Vec3> positions, std::span<const Vec3> velocities);
  // The plane through `foot` with unit `normal`, the cloth above it.
  void set_plane(const Vec3& normal, const Vec3& foot);
  void set_gravity(const Vec3& gravity) { gravity_ = gravity; }
  void set_friction(double friction) { friction_ = friction; }
  void set_hands(std::span<const PaperHand> hands) { hands_.assign(hands.begin(), hands.end()); }
  // The bubble holds `volume` (m3) of air at ambient pressure: K of (3.8). The switch of the thesis'
  // figure 4.1.
  void set_air(double volume, double ambient = 101325) { air_ = ambient * volume, ambient_ = ambient; }
  void set_air_on(bool on) { air_on_ = on; }

  // A frame of `dt` in equal steps no longer than the settings'. Returns their number.
  int step(double dt);

  const std::vector<Vec3>& positions() const { return positions_; }
  const std::vector<Vec3>& velocities() const { return velocities_; }
  double volume() const;  // (3.10), m3
  double gauge() const;   // pressure of the bubble less the ambient one, Pa; 0 when the air is switched off
  // What holds a point against its springs (without dampers), weight and the exact gradient of the air's
  // energy, N.
  Vec3 hand_force(int point) const;
  double kinetic_energy() const;  // J
  double potential_energy()
      const;  // J: springs, weight, air (with the exact gradient, what it does work from)

 private:
  void guide(double from, double to, double dt);
  Vec3 into(const Vec3& position) const { return axes_ * (position - origin_); }
  double gauge_of(double volume) const;

  ClothPattern pattern_;
  Fabric fabric_;
  PaperSettings settings_;
  std::unique_ptr<PaperStepper> stepper_;
  std::vector<Vec3> positions_, velocities_;
  std::vector<PaperHand> hands_;
  std::vector<Vec3> starts_, start_velocities_;
  Mat3 axes_ = Mat3::Identity();  // rows: two directions along the plane and its normal
  Vec3 origin_ = Vec3::Zero();    // on the plane
  Vec3 gravity_{0, 0, -9.8};
  double friction_ = 0.4, air_ = 0, ambient_ = 101325;
  bool air_on_ = true;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "softpoint/cloth/air.h"
#include "softpoint/cloth/cloth_profile.h"
#include "softpoint/cloth/cloth_settings.h"
#include "softpoint/cloth/paper_settings.h"
#include "softpoint/cloth/pattern.h"
#include "softpoint/cloth/wetness.h"
#include "softpoint/core/deformable.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Whether and how a cloth meets itself.
struct SelfContact {
  bool on = false;  // off: it passes through itself; on: motion is of first order in time where it may meet
  double friction = 0.3;  // of cloth on cloth, Coulomb's coefficient; 0 to 100
};
// Throws Error naming the field, as "<name>.friction".
SOFTPOINT_API void check(const SelfContact& settings, std::string_view name = "self_contact");

// What a cloth is before it is put into a world.
struct ClothDesign {
  ClothPattern pattern;            // dry
  Fabric fabric;                   // the one the pattern was made with
  Wetness wetness;                 // what water does to it
  std::vector<double> saturation;  // 0 to 1, one a point; empty: dry
  AirSettings air;                 // which bubbles there are and what limits them
  SelfContact self_contact;
  ClothSettings solver;     // the dial between speed and accuracy
  std::vector<Vec3> start;  // where the points begin, m, in the frame of the pattern; empty: in its shape
  // The thesis' own scheme instead of the solver: a sheet on a grid, one plane (the first that is near) and
  // one bubble, hands as strong as they need be; everything else around it and `wetness` but for the mass are
  // left out.
  std::optional<PaperSettings> paper;
};

// A volume of air in or under a cloth, after the last step.
struct BubbleState {
  int faces = 0;        // of the cloth round it
  double area = 0;      // m2, of these faces at rest
  double volume = 0;    // m3
  double pressure = 0;  // Pa, absolute
  double air = 0;       // J, pressure times volume
  bool open = false;    // to the atmosphere
};

// Where the air has gone, J: air + vented - initial = audit, which is rounding.
struct AirBalance {
  double air = 0;      // in all bubbles
  double vented = 0;   // left for the atmosphere, less what came from it
  double audit = 0;    // what the sum differs by from the beginning
  double initial = 0;  // at the beginning
};

// Strains of the structural springs: 0.01 is one per cent longer than at rest.
struct StretchState {
  double largest = 0;  // positive when stretched
  double p99 = 0;      // 99 in 100 are stretched less
  double mean = 0;     // of the sizes, stretched or shortened
};

// A piece of cloth in a Bullet world: dry or wet, with the air it traps, pulled by hands, in contact with the
// world and with itself. Contact is solved here, in steps of a millisecond, not by core. Points, springs, air
// and what resists it: README of the plugin; how it is solved: doc/solver.md.
//
// Friction against other objects is set as on any Bullet object (setFriction, combined as Bullet does it);
// where the cloth is wet it is multiplied by friction_factor(). DeformableSystem::grab, attach and pick work
// as on any deformable; a held point is held exactly unless its force is limited.
class SOFTPOINT_API Cloth final : public Deformable {
 public:
  // Puts the pattern's origin at `position` (m), turned by `rotation`, at rest. Throws Error for what is out
  // of range in the design, points farther out than kMaxPosition and what is no rotation.
  explicit Cloth(const ClothDesign& design, const Vec3& position = Vec3::Zero(),
                 const Mat3& rotation = Mat3::Identity());
  ~Cloth() override;

  const ClothPattern& pattern() const;  // dry
  const Fabric& fabric() const;
  const Wetness& wetness() const;

  // Setters wake the cloth and act from the next step on. They throw Error with nothing changed for what is
  // out of range; the message names field, value and what is permitted.
  void set_settings(const ClothSettings& settings);
  const ClothSettings& settings() const;
  void set_air(const AirSettings& settings);
  const AirSettings& air() const;
  void set_saturation(std::span<const double> saturation);  // 0 to 1, one a point
  std::span<const double> saturation() const;
  void set_self_contact(const SelfContact& settings);
  const SelfContact& self_contact() const;
  void set_wind(const Vec3& velocity);  // m/s, of the air that drag is relative to
  const Vec3& wind() const;
  // As one body: `linear` (m/s) of the centre of mass, `angular` (rad/s) about it.
  void set_velocity(const Vec3& linear, const Vec3& angular = Vec3::Zero());

  // After the last step.
  std::span<const Vec3> contact_forces() const;  // N on each point by colliders, mean over the step
  double contact_area() const;                   // m2, at rest, of the points that colliders push
  std::span<const BubbleState> bubbles() const;
  AirBalance air_balance() const;
  StretchState stretch() const;
  double elastic_energy() const override;  // J, of springs and bending
  const ClothProfile& profile() const;
  // Pairs of faces without a common point that cut each other, by trying all near pairs: slow.
  int count_intersections() const;

 private:
  bool solves_contact() const override { return true; }
  void advance_by(double dt, const Vec3& acceleration, NearColliders& near,
                  std::span<HeldPoint> held) override;
  void commit(double dt) override;
  void restored() override;
  std::string_view kind() const override { return "cloth"; }
  void archive_state(StateArchive& archive) override;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

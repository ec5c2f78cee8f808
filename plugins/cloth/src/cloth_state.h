#pragma once

#include <vector>

#include "bubble_finder.h"
#include "cloth_solver.h"
#include "collider_coupling.h"
#include "contact_gatherer.h"
#include "paper_cloth.h"
#include "self_contact.h"
#include "softpoint/cloth/cloth.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// What a cloth is made of and what it goes on from; the stages of its step (cloth_step.cpp, cloth_air.cpp,
// cloth_self.cpp).
struct __attribute__((visibility("hidden"))) Cloth::State {
  explicit State(const ClothDesign& made);

  ClothDesign design;
  ClothPattern wet;  // with the masses and stiffnesses of the present saturation
  Vec3 wind = Vec3::Zero();
  ClothSolver solver;
  BubbleFinder finder;
  ContactGatherer gatherer;
  SelfContactPass self;
  ColliderCoupling coupling;
  ClothProfile profile;

  void take_saturation();
  bool airy() const;  // some of it can hold air

  // The stages of a step.
  void gather(const NearColliders& near, double dt, const Vec3& acceleration);
  bool find_bubbles(const NearColliders& near);
  void place_hands(double rest, NearColliders& near, std::span<HeldPoint> held);
  double tied_mass(const NearColliders& near, int collider, const Vec3& point) const;
  ClothHand hand_for(const HeldPoint& held, double rest, const NearColliders& near) const;
  void follow(NearColliders& near, double rest, std::span<HeldPoint> held);
  void feel_air();
  void measure_open_bubbles();
  void carry_air(const NearColliders& near);
  void choose_carrier(const NearColliders& near);
  void couple(double h, NearColliders& near, std::span<HeldPoint> held);
  void begin_self(std::span<const HeldPoint> held);
  void prepare_self(std::span<const HeldPoint> held);
  void meet_self(double h, std::span<const HeldPoint> held);
  void calm_self(double excess);
  void end_air(double dt, NearColliders& near);
  // All of it in the `paper` mode (cloth_paper.cpp).
  void advance_paper(double dt, const Vec3& acceleration, NearColliders& near, std::span<HeldPoint> held);
  bool paper_plane(const NearColliders& near, const Vec3& acceleration);
  void read(double dt, NearColliders& near, std::span<HeldPoint> held);

  // The `paper` mode, if it is that.
  std::unique_ptr<PaperCloth> paper;
  std::vector<PaperHand> paper_hands;
  bool paper_on_plane = false;
  Vec3 paper_normal = Vec3::Zero();
  double paper_offset = 0;  // m
  double paper_air = -1;    // m3 at ambient pressure; below 0 until there is a plane

  // The step at work, world frame.
  std::vector<Vec3> positions, velocities, before;
  std::vector<Vec3> local_positions, local_feet;  // about `air_origin`, for the air
  std::vector<double> friction_factor;
  std::vector<double> inverse_masses;  // 1/kg; 0 where held
  bool self_near = false;              // cloth may meet cloth in this frame
  double self_energy = 0;              // J, mechanical, at the end of the last small step
  Vec3 air_origin = Vec3::Zero();
  Vec3 air_shift = Vec3::Zero();      // m, of what the bubbles lie on, since the frame began
  Vec3 carrier_start = Vec3::Zero();  // m, centre of it then
  int carrier = -1;                   // the collider
  std::vector<int> air_colliders, carrier_votes;
  std::vector<Vec3> world_feet;
  bool air_on = false;
  double dt = 0;
  std::vector<double> volumes, gauges;
  std::vector<Vec3> foot_forces;
  std::vector<ClothHand> hands;
  struct HandOf {  // a held point, and the hand that holds it with others
    int hand = -1;
    double share = 0;
  };
  std::vector<HandOf> hand_of;
  std::vector<int> ties;  // points tied to each collider

  // Where the targets of handles were, so that hands move at their own speed.
  struct LastTarget {
    long long handle = 0;
    Vec3 target = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();  // m/s, at the end of the last step
  };
  std::vector<LastTarget> last_targets, next_targets;

  std::vector<Vec3> contact_forces;
  std::vector<BubbleState> bubbles;
  std::vector<double> point_areas;  // m2
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

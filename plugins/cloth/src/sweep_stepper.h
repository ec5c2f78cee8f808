#pragma once

#include <array>
#include <vector>

#include "cloth_stepper.h"
#include "coarse_level.h"
#include "march_grid.h"
#include "sweep_arrays.h"
#include "sweep_kernels.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// The solver of doc/solver.md with numbers of type T (air's bookkeeping in double). Positions are kept
// relative to an origin near the cloth.
template <class T>
class SweepStepper final : public ClothStepper {
 public:
  explicit SweepStepper(std::shared_ptr<ClothInputs> inputs);

  void set_positions(std::span<const Vec3> positions) override;
  void set_velocities(std::span<const Vec3> velocities) override;
  void masses_changed() override { masses_dirty_ = true; }
  void forces_changed() override { forces_dirty_ = true; }
  void stiffness_changed() override { springs_dirty_ = true; }
  void contacts_changed() override { contacts_dirty_ = true, contacts_time_ = time_; }
  void hands_changed() override;
  void air_changed() override { air_dirty_ = true; }

  int& calm() override { return calm_; }
  std::vector<double>& gauges() override { return gauges_; }
  int touch_state(int point) const override {
    return static_cast<int>(arrays_.field(SweepArrays<T>::kTouch)[in_->layout.slot_of[point]]);
  }
  void set_touch_state(int point, int state) override {
    arrays_.field(SweepArrays<T>::kTouch)[in_->layout.slot_of[point]] = static_cast<T>(state);
  }
  int begin_frame(double dt) override;
  void substep() override;
  void end_frame() override;

  Vec3 position(int point) const override;
  Vec3 velocity(int point) const override;
  Vec3 contact_force(int point) const override;
  Vec3 mean_contact_force(int point) const override;
  bool touching(int point) const override;
  Vec3 hand_force(int hand) const override;
  Vec3 hand_impulse(int hand) const override;
  double kinetic_energy() const override;
  double potential_energy() const override;
  double mechanical_energy() const override;
  std::span<const PocketState> pockets() const override { return pocket_states_; }

 private:
  struct Hand {
    int point = -1;
    int slot = -1;
    int colour = -1;
    bool limited = false;
    double max_force = 0;
    double mass = 0;  // kg; of one that gives way
    Vec3 from = Vec3::Zero(), from_velocity = Vec3::Zero();  // world, at the start of the frame
    Vec3 to = Vec3::Zero(), to_velocity = Vec3::Zero();      // world, at its end
    Vec3 impulse = Vec3::Zero();                             // N s, of the last small step
    Vec3 at = Vec3::Zero();                                  // local, at the end of the small step
    // of an explicit step: change of velocity to hold it, force, whether the force suffices
    Vec3 change = Vec3::Zero(), push = Vec3::Zero(), speed = Vec3::Zero();
    bool holds = false;
  };
  // A point with two planes: solved by itself.
  struct Wedge {
    int point, slot, colour;
  };
  struct RimEdge {
    int a, b, pocket;  // points; runs along the face
  };
  // A face at a point whose other faces belong to another pocket.
  struct StrayFace {
    int slot, j, k, pocket;  // slots
    bool counts;             // in the volume
  };

  // stepper_inputs-inl.h
  void load_inputs();
  void load_masses();
  void load_forces();
  void load_springs();
  void find_stiffest();
  void load_contacts();
  void load_hands();
  void move_origin(const Vec3& origin);
  // In single a place is two numbers: see Places in gather-inl.h.
  static constexpr bool kTwo = sizeof(T) == 4;
  Vec3 local(int slot) const;
  Vec3 started(int slot) const;
  void place(int slot, const Vec3& x);
  void copy_places(int from, int from_low, int to, int to_low);
  Vec3 vector_at(int field, int slot) const;
  void set_vector(int field, int slot, const Vec3& v);

  // stepper_air-inl.h
  void load_air();
  void find_neighbour_faces();
  void begin_air();
  void add_rims();
  void measure_volumes();
  void solve_gauge(std::size_t pocket, const PocketSums& sums);
  double air_energy() const;

  // stepper_coarse-inl.h
  static constexpr double kOvershoot = 0.25;  // of the push that the way began with
  static constexpr int kSearchRounds = 4;
  void assemble_coarse();
  void coarse_step();
  void measure_air();
  void carry(std::span<const double> way);
  void move_along(double part);

  // stepper_guard-inl.h
  static constexpr int kCalm = 16, kCalmEvery = 4;  // small steps
  double total_energy(double* kinetic) const;
  double work() const;
  struct Motion {
    Vec3 mean = Vec3::Zero();          // m/s
    double of_mean = 0, relative = 0;  // J
  };
  Motion motion(int field) const;
  double payable() const;
  void damp(double excess);
  void restore();
  void guard();

  // stepper_march-inl.h
  static constexpr double kMostSmoothed = 14;       // share * stiffness/mass of a cloth of 50 x 50 points
  static constexpr double kMostSmoothedAtAll = 32;  // and of any
  static constexpr double kMarchMargin = 1.05;      // of what keeps steps stable
  static constexpr int kGradientEvery = 4;          // explicit steps from one dV/dx to the next
  bool marches();
  bool may_march();
  void choose_unit();
  void load_march();
  void load_motion();
  typename MarchPlace<T>::Type place_of(double x) const;
  Vec3 hand_at(const Hand& hand, double time) const;
  Vec3 march_vector(T* const* field, const Hand& hand) const;
  double hold(const Hand& hand, double h);
  bool march();
  bool soft_air(double h) const;
  bool guard_march();

  // stepper_report-inl.h
  Vec3 gradient(int slot, bool dynamic) const;
  Vec3 force_of(const Hand& hand) const;

  // sweep_stepper.cpp, stepper_sweep-inl.h and stepper_alone-inl.h
  // Springs of calm cloth turn by less than kCalmTurn (1/s, root mean square): small steps are those of the
  // dial. Up to kMostTurns times as many where they turn faster; a round of coarse correction and sweep in a
  // small step for each kRoundTurn (1/s), kMostRounds at most.
  static constexpr double kCalmTurn = 5, kMostTurns = 4, kRoundTurn = 1;
  static constexpr int kMostRounds = 4;
  static constexpr double kMarchPart = 0.25;  // small steps of explicit ones over those of the dial
  double turn_rate() const;
  void predict();
  void solve_parts();
  void solve();
  void sweep();
  void sweep_colour(int colour);
  void solve_alone(int slot, const Hand* hand, const PointContacts* planes);
  Vec3 stick_or_slide(const ContactPlane& plane, int slot, const Vec3& dx, const Mat3& h, Vec3& force,
                      T& state) const;
  void finish();
  void report();

  int colour_of(int slot) const;
  bool held(int slot) const;

  const SweepKernels<T>& kernels_;
  SweepArrays<T> arrays_;
  SweepData<T> data_;
  Vec3 origin_ = Vec3::Zero();
  double dt_ = 0, h_ = 0, time_ = 0;  // of the frame, of a small step, since the frame began
  double contacts_time_ = 0;          // when the contacts were set
  double hands_time_ = 0;             // when the hands were set
  double shorter_ = 0;                // of the small step as points of second order see it
  double h_before_ = 0;               // of the small step before
  bool fresh_ = true;                 // there is none before
  double springs_h_ = 0;              // what the dampers are made for
  bool masses_dirty_ = true, forces_dirty_ = true, springs_dirty_ = true, contacts_dirty_ = true,
       air_dirty_ = true;
  bool set_anew_ = true;  // positions, velocities, hands or the origin
  bool has_planes_ = false, planes_move_ = false;
  std::vector<Hand> hands_;
  std::vector<Wedge> wedges_;

  std::unique_ptr<CoarseLevel> coarse_;
  bool coarse_ready_ = false, coarse_made_ = false;  // factored; assembled in this frame
  std::vector<char> moves_;
  std::vector<double> inertia_, pull_, bubble_, bubble_way_;

  double energy_ = 0, work_ = 0;  // J, when last checked; since then
  double before_ = 0;             // the work before this small step
  int parts_ = 1;                 // of a small step that is swept
  int rounds_ = 1;                // of coarse correction and sweep in a small step
  double farthest_ = 0;           // m2, square of the longest move of a sweep in this small step
  int calm_ = 0, unchecked_ = 0;  // checks in a row that were fair, small steps since the last one

  const MarchKernels<T>& march_kernels_;
  const int march_bytes_;  // of their vectors
  std::unique_ptr<MarchGrid<T>> march_;
  bool march_dirty_ = true, march_fresh_ = true, march_feet_ = true, march_off_ = false;
  bool marches_ = false;  // in this frame
  bool marched_ = false;  // this small step
  int march_count_ = 0, march_pocket_ = -1;
  double march_share_ = 0, march_work_ = 0;
  double stiffest_ = 0;  // of springs over mass, 1/s2

  bool air_ = false;  // some pocket has a pressure
  std::vector<PocketState> pocket_states_;
  std::vector<double> gauges_, volumes_, change_;
  std::vector<PocketSums> sums_;
  std::vector<RimEdge> rim_edges_;
  std::vector<StrayFace> strays_;
  std::vector<int> rim_slots_;
  std::vector<std::array<int, 3>> across_;  // per face and corner k: the face over the edge k, k + 1, or -1
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth

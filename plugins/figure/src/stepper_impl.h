#pragma once

#include <memory>
#include <vector>

#include "anderson.h"
#include "ball_range.h"
#include "link_chain.h"
#include "runge_kutta.h"
#include "softpoint/figure/figure_stepper.h"
#include "variational_step.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Where a joint stands against its range.
enum class Stop : signed char { kLower = -1, kFree = 0, kUpper = 1 };

struct __attribute__((visibility("hidden"))) FigureStepper::Impl {
  Impl(const FigureModel& model, FigureState start, Integrator how);

  // The plain step from `state` by `dt` into `next`: what is stopped stands still.
  void advance(double dt);
  void advance_by_stages(double dt, const ButcherTable& table);
  double part_of(double dt) const;  // s, of which no joint turns further than explicit stages can follow
  // A part of at most `rest` s, or all of it, from `state` into `next`; what it covers.
  double part_by_stages(double rest, bool all_of_it, const ButcherTable& table);
  double part_by_extrapolation(double rest, bool all_of_it);
  void advance_as_paper(double dt);
  void advance_by_variation(double dt);
  bool solve_variational(double dt);  // false: no end was found
  // The prescribed and stopped joints at a time, in `to`; their accelerations in `qdd`.
  void prescribe(double at, FigureState& to, std::vector<double>& qdd);
  void set_joints();  // tells the dynamics which joints are dynamic: chosen and not stopped

  // Limits, exact.
  void step_with_stops(double dt);
  double advance_to_event(double dt);  // s covered
  void meet_stops(double at);          // impulses of joints that run against their stops
  void lean_on_stops(double at);  // who is held and who leaves, by the signs of accelerations and torques
  bool crosses(std::size_t joint, double length, double& t, double& beyond);
  double locate_impact(std::size_t joint, double t, double beyond);
  double locate_release(double length);
  void torques_of_stops(FigureState& at, double when);
  void keep_inside();
  double longest_part() const;  // s, before a ball could go through its cone on the far side
  void note(double at, int joint, bool impact);

  // Viscous friction that explicit stages would not bear.
  void gather_viscous(const FigureModel& model);
  bool rubs_hard(double dt);

  // Dry friction.
  struct Dry {
    int link;
    std::size_t v;
    int range;     // which of the joints with a range; -1: none
    double limit;  // N m (N)
    bool stopped(const std::vector<Stop>& all) const {
      return range >= 0 && all[static_cast<std::size_t>(range)] != Stop::kFree;
    }
  };
  bool stands(const Dry& joint) const;       // prescribed, or against a stop
  void rub(double length, FigureState& at);  // impulses of so many seconds
  void hold_at_rest();                       // what sticks stands through the step
  void begin_with_friction(double dt);       // the first half of its impulses
  void end_with_friction(double dt, bool good);

  // Limits, the paper's.
  void step_as_paper_with_limits(double dt);

  bool finite() const;

  // A range: of a joint's own number, or of the swing or the twist of a ball.
  struct Limited {
    enum class Part : signed char { kNumber, kSwing, kTwist };
    int link, q, v;
    double lower, upper;
    Part part;
    int ball;  // which of `ball_ranges`
  };
  // Where it is, rad or m: exactly at a bound that it misses by no more than a rounding. Its rate; both moved
  // to where they belong.
  double place_of(const Limited& joint, const FigureState& at) const;
  double next_place(const Limited& joint) const;  // in `next`, turns counted on from those of `state`
  double rate_of(const Limited& joint, const FigureState& at) const;
  BallRange::Row row_of(const Limited& joint, const FigureState& at) const;
  void put(const Limited& joint, double bound, FigureState& at) const;
  void calm(const Limited& joint, FigureState& at) const;
  double pull_of(std::size_t i) const;  // N m, N: what the stop gives
  // What `acceleration` gives the range's own number; `seen` holds the rows of balls.
  double gain_of(std::size_t i, bool with_bias) const;
  void look_at_balls(const FigureState& at);

  // Rows: balls that lean on their ranges, and pinned points. Forces along them by H^-1 J^T, one O(N) answer
  // a row, on top of what the articulated bodies give: (32) to (34) of doc/dynamics.md.
  struct Row {
    int limited;  // or
    int pin, axis;
    Vec3 gradient;
    double bias;
  };
  struct Pin {
    LinkChain chain;
    PinnedPoint at;
  };
  enum class Keep { kAccelerations, kRates };
  bool any_rows() const;
  void list_rows(const FigureState& at);
  void assemble_rows(const FigureState& at);
  void along_rows(const FigureState& at, const double* x, double* out) const;  // J x
  void solve_rows();                                                           // `right` to `lambda`
  void add_rows(double* to) const;                                             // H^-1 J^T lambda
  // After forward() at that state: changes the accelerations, or increments of rates, so that the rows are
  // kept; `wanted` (one number a row, null: none) is what they are to come to.
  void keep_rows(const FigureState& at, double* qdd, Keep what);
  void keep_rows_to(const FigureState& at, double* qdd, const std::vector<double>& wanted);
  void take_loads(const FigureState& at);
  void move(double dt);            // one step, friction apart
  void move_with_pins(double dt);  // stopped dead where there is no way to go
  bool went_well(double energy);
  void make_room_for_rows();
  void take_part();                   // what is tried is taken over
  void settle_rows(FigureState& at);  // positions and rates on the rows to the last digits
  // forward() with the rows kept.
  void answer(const FigureState& at, const double* tau, double* qdd);

  FigureDynamics dynamics;
  Integrator integrator;
  LimitMode limits = LimitMode::kNone;
  FigureState state, next, stage, begin, whole, parts_from, before_friction;
  const PrescribedMotion* motion = nullptr;
  double time = 0;
  long long guard_fired = 0, unsolved = 0, parts = 0;
  std::vector<double> increment, acceleration, torque, still, change;
  std::unique_ptr<VariationalStep> variational;  // of that integrator alone
  std::unique_ptr<Anderson> accelerator;
  std::vector<double> rates[6], accelerations[6];

  std::vector<char> chosen;          // per link: dynamic if nothing stops it
  std::unique_ptr<bool[]> joints;    // per link, as told to the dynamics
  std::vector<int> standing;         // links that are not dynamic
  std::vector<Limited> limited;      // joints with a range
  std::vector<std::size_t> turning;  // degrees of freedom in rad
  std::vector<BallRange> ball_ranges;
  std::vector<BallRange::Row> seen;  // per range
  std::vector<double> ball_pulls;    // N m, per range of a ball
  std::vector<Pin> pins;
  std::vector<Row> rows;
  std::vector<double> columns, mobility, right, lambda, factor, row_scratch, row_wanted, row_increment,
      row_kept, pinned_rates;
  std::vector<int> row_order;
  std::vector<Wrench> pin_loads;
  std::vector<Vec3> pin_impulses, part_impulses;  // N s, of the step so far; of the part that is tried
  std::vector<Dry> dry;                           // joints with dry friction
  std::vector<signed char> slides;  // per dry joint: the sign of its sliding, 0 for one that sticks
  std::vector<char> held;           // per dry joint: stands by its friction
  std::vector<double> dry_torque;
  std::vector<Stop> stops;       // per limited joint: leaning on it
  std::vector<Stop> candidates;  // the side that is looked at
  std::vector<Stop> leaning;     // before it is found out anew
  std::vector<char> stubborn;    // met its stop again at once, in the last part of the step: leans on it
  std::vector<int> let_go;       // per limited joint: releases inside this step
  int met = -1;                  // which joint ended that part; -1: none
  std::vector<char> grazing;     // met no stop after all, in this part of the step
  std::vector<LimitEvent> events;
  LimitCounts counts;
  int blows = 0;                 // impacts and releases of this step
  std::vector<double> viscous;   // N m s (N s/m), per degree of freedom
  double fastest_decay = 0;      // 1/s, at most: by the armatures alone
  bool rubbing_hard = false;     // this step
  std::vector<double> friction;  // per degree of freedom: natural logarithm of the factor in 1 s
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

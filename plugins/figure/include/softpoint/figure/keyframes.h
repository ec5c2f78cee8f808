#pragma once

#include <vector>

#include "softpoint/figure/figure_model.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// How a joint moves from key to key. Turns of balls and free joints are products of turns with the same
// weights, so that their spins are met as rates are.
enum class Interpolation {
  kQuadratic,  // from position and rate of one key to the position of the next; the rate there follows
  kCubic,      // Hermite; rates that no key gives are those of a parabola through three keys
  kMonotone,   // cubic that stays between its keys (Fritsch and Carlson); turns as kCubic
  kSmooth,     // cubic with a continuous acceleration
  kQuintic     // continuous acceleration, takes on rates and accelerations where dynamics begin and end
};
// "quadratic", "cubic", "monotone", "smooth", "quintic".
SOFTPOINT_API const char* name(Interpolation interpolation);

// A joint at one time, laid out as JointKind says.
struct JointKey {
  double time = 0;         // s
  std::vector<double> q;   // as many numbers as the joint's position has
  std::vector<double> qd;  // rates, where they are given; else empty
};

// A joint's keys in order of time. Before the first and after the last it stands still.
struct JointTrack {
  int link = 0;
  Interpolation interpolation = Interpolation::kCubic;
  std::vector<JointKey> keys;
};
// Throws Error, naming link, key and what is permitted, unless the track fits the model: at least one key,
// times ascending by 1e-6 s or more, as many finite numbers as the joint has. Quaternions become unit ones.
SOFTPOINT_API void check_track(const FigureModel& model, JointTrack& track);

// Position, rate and acceleration of a track at one time, on its keys alone; arrays of 7, 6 and 6 numbers of
// which as many as the joint has are written.
class SOFTPOINT_API TrackSpline {
 public:
  // `track` passed check_track(). With `runs_on` dynamics take over at the last key: its rate
  // is what the keys before it give, not rest.
  TrackSpline(const FigureModel& model, const JointTrack& track, bool runs_on = false);
  // The same beginning with a known acceleration (empty: none), which only kQuintic takes on.
  TrackSpline(const FigureModel& model, const JointTrack& track, const std::vector<double>& acceleration,
              bool runs_on);

  void evaluate(double time, double* q, double* qd, double* qdd) const;
  // The numbers that it consists of between two times: equal ones mean the same motion there.
  void append_numbers(double begin, double end, std::vector<double>& to) const;

 private:
  // From one key to the next: increments that weights of Bernstein's kind, growing from 0 to 1, bring in one
  // after the other.
  struct Segment {
    double begin = 0, end = 0;  // s
    double slide[3], slides[5][3];
    double turn[4], turns[5][3];  // quaternion; rad, in the turned axes
  };
  void build(const JointTrack& track, const std::vector<double>& acceleration, bool runs_on);

  JointKind kind_;
  int slides_ = 0;  // numbers that add up
  bool turns_ = false;
  int degree_ = 3;
  std::vector<Segment> segments_;
  JointKey first_;  // of a track of one key
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

#pragma once

#include <chrono>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// What the last substep cost, did and skipped; the totals run since the system was attached.
struct Profile {
  // Wall seconds of the last substep, by stage.
  struct Seconds {
    double predict = 0;     // free motion of every deformable
    double detect = 0;      // contact points at the end of the step
    double compliance = 0;  // response of the touched points to impulses
    double solve = 0;       // impulses
    double commit = 0;      // new positions and velocities, guard
    double mirror = 0;      // copy into Bullet's nodes, faces and bounds
    // Sum of the stages.
    double total() const { return predict + detect + compliance + solve + commit + mirror; }
  };
  // Work of the last substep.
  struct Counts {
    int deformables = 0;       // in the system
    int sleeping = 0;          // of them, left out altogether
    int normals = 0;           // of them, whose normals were mirrored
    int without_pairs = 0;     // deformables that skipped detection: nothing was near
    int without_contacts = 0;  // deformables that skipped compliance: nothing touched
    int pairs = 0;             // (deformable, collider) pairs the broadphase let through
    int pairs_skipped = 0;     // pairs whose shapes have no contact with deformables (see README)
    int swept_queries = 0;     // bodies that move farther than the broadphase knew
    int mesh_patches = 0;      // patches of triangle meshes collected anew
    int contacts = 0;          // contact points handed to the solver in the last pass
    int support_points = 0;    // rigid-rigid contact points re-solved together with ours
    int handles = 0;           // held points, anchors included
    int anchors = 0;           // points tied to objects
    int passes = 0;            // detection and solution rounds
    int iterations = 0;        // Gauss-Seidel sweeps over all passes
    double residual = 0;       // m, last change of a contact point in the last sweep
  };
  // Sums over all substeps.
  struct Totals {
    long long substeps = 0;          // since the system was attached
    long long guard_fired = 0;       // times a body was put back because a number was not finite
    long long late_substeps = 0;     // substeps solved after integration: the solver tap was not called
    long long refactorizations = 0;  // response matrices made anew because the time step changed
    long long anchors_released = 0;  // anchors whose object left the world
  };

  Seconds seconds;  // of the last substep
  Counts counts;    // of the last substep
  Totals totals;    // of all
};

// Adds the wall time of its own life to a field of Profile::Seconds.
class StageTimer {
 public:
  // Starts the clock; adds to `sum` (s) when destroyed.
  explicit StageTimer(double& sum) : sum_(sum), start_(Clock::now()) {}
  ~StageTimer() { sum_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& sum_;
  Clock::time_point start_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI

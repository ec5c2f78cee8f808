#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "softpoint/figure/figure_stepper.h"
#include "softpoint/figure/swing_twist.h"
#include "support.h"

namespace softpoint::figure {

// Half a second from many random starts, at three lengths of steps: within the ranges, no search unfinished,
// no guard. `start(random, trial)` makes the stepper; `impacts` a start are to be met at least.
template <class Start>
void expect_many_starts_stay_inside(int starts, unsigned seed, int impacts, Start start) {
  for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
    RandomFigures random(seed);
    double violation = 0;
    LimitCounts sum;
    long long guard = 0;
    for (int trial = 0; trial < starts; ++trial) {
      FigureStepper stepper = start(random, trial);
      stepper.set_limits(LimitMode::kExact);
      for (int i = 0; i * dt < 0.5; ++i) {
        stepper.step(dt);
        violation = std::max(violation, outside_ranges(stepper.dynamics().model(), stepper.state()));
      }
      const LimitCounts& counts = stepper.limit_counts();
      sum.impacts += counts.impacts;
      sum.releases += counts.releases;
      sum.passes += counts.passes;
      sum.capped += counts.capped;
      sum.unfinished += counts.unfinished;
      guard += stepper.guard_fired();
    }
    std::printf("    dt %.4f: %lld impacts, %lld releases, %lld passes, outside by %.1e\n", dt, sum.impacts,
                sum.releases, sum.passes, violation);
    EXPECT_GT(sum.impacts, impacts * starts);
    EXPECT_LE(violation, 1e-10);
    EXPECT_EQ(sum.capped, 0);
    EXPECT_EQ(sum.unfinished, 0);
    EXPECT_EQ(guard, 0);
  }
}

}  // namespace softpoint::figure

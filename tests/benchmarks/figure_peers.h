#pragma once

#include <memory>
#include <string>
#include <vector>

#include "softpoint/figure/figure_model.h"

namespace softpoint::benchmarks {

// The same figure in another engine: one call is one forward dynamics in a state that stays as it is.
class FigurePeer {
 public:
  virtual ~FigurePeer() = default;
  virtual std::string name() const = 0;
  virtual void forward() = 0;
  virtual double largest_acceleration() = 0;  // so that nothing is left out
};

// Hinges and one free joint only. Inertias by their diagonal, links without mass of a microgram: what it can
// represent; the time is the same.
std::unique_ptr<FigurePeer> multibody_peer(const figure::FigureModel& model,
                                           const figure::FigureState& state);
// Null if the program was built without it. Its crb, factor and rne alone, or `whole`: with the poses and
// velocities that they want and the solution, which our calls and btMultiBody's have within them.
std::unique_ptr<FigurePeer> mujoco_peer(const figure::FigureModel& model, const figure::FigureState& state,
                                        bool whole);
// Null if the program was built without them; from positions and velocities to accelerations.
std::unique_ptr<FigurePeer> dart_peer(const figure::FigureModel& model, const figure::FigureState& state);
std::unique_ptr<FigurePeer> simbody_peer(const figure::FigureModel& model, const figure::FigureState& state);

}  // namespace softpoint::benchmarks

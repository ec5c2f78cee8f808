// What `softpoint figure` reads but skeletons: models as plain text, states, tables of prescribed motion. The
// first letter says which: m, s or p.
#include <cmath>
#include <sstream>

#include "figure_prescription.h"
#include "figure_state_file.h"
#include "fuzz/fuzz_support.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"

using namespace softpoint;

namespace {

// A free base, a hinge, a ball and a slider.
const figure::FigureModel& arm() {
  static const figure::FigureModel model = [] {
    std::istringstream in(
        "base -1 0 0 0 0 0 0 0 5 0 0 0 1 1 1 0 0 0 0 0\n"
        "hip 0 1 0 1 0 0 0 -0.2 1 0 0 -0.5 0.1 0.1 0.01 0 0 0 -1 1\n"
        "neck 0 2 0 0 0 0 0 0.2 1 0 0 0.5 0.1 0.1 0.01 0 0 0 0 0\n"
        "lift 1 3 0 0 1 0 0 -1 1 0 0 -0.5 0.1 0.1 0.01 0 0 0 -1 1\n");
    return figure::read_amdl(in, "arm");
  }();
  return model;
}

bool finite(const std::vector<double>& numbers) {
  for (const double x : numbers) {
    if (!std::isfinite(x)) return false;
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1 || size > 1 << 14) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if (data[0] == 'm') {
      std::istringstream in(text);
      const figure::FigureModel model = figure::read_amdl(in, "fuzz");
      figure::FigureState state = figure::rest_state(model);
      figure::check_state(model, state);
      figure::FigureDynamics dynamics(model);
      std::vector<double> qdd(state.qd.size());
      dynamics.forward(state.q.data(), state.qd.data(), nullptr, qdd.data());
    } else if (data[0] == 's') {
      figure::FigureState state = scene::read_figure_state(text, "fuzz", arm());
      fuzz::require(finite(state.q) && finite(state.qd), "a state is finite");
      figure::check_state(arm(), state);
    } else {
      const scene::FigurePrescription motion(text, "fuzz", arm());
      fuzz::require(motion.last_time() > motion.first_time(), "times increase");
      figure::FigureState state = figure::rest_state(arm());
      std::vector<double> qdd(state.qd.size());
      motion.evaluate(0.5 * (motion.first_time() + motion.last_time()), state.q.data(), state.qd.data(),
                      qdd.data());
      fuzz::require(finite(state.q), "what is prescribed is finite");
    }
  } catch (const Error&) {
  }
  return 0;
}

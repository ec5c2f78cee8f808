// A double pendulum swings without torque and keeps its energy.
#include <cmath>

#include "app.h"
#include "softpoint/figure/figure_stepper.h"

int main() {
  using namespace softpoint::figure;
  std::vector<Link> links(2);
  for (int i = 0; i < 2; ++i) {
    Link& link = links[static_cast<std::size_t>(i)];
    link.name = i == 0 ? "upper" : "lower";
    link.parent = i - 1;
    link.axis = softpoint::Vec3::UnitY();
    link.origin = {0, 0, i == 0 ? 0.0 : 1.0};
    set_cylinder(link, 1.0, 0.05, 1.0);
  }
  const FigureModel model(links);
  FigureState state = rest_state(model);
  state.q = {1.5, 0.4};
  FigureStepper stepper(model, state);
  const double before = stepper.energy();
  for (int i = 0; i < 240; ++i) stepper.step(1.0 / 240);
  std::printf("energy %.9f J, was %.9f J\n", stepper.energy(), before);
  require(std::abs(stepper.energy() - before) < 1e-4 * std::abs(before), "energy is kept");

  require_refusal([&] { stepper.step(-1); }, "dt = -1");
}

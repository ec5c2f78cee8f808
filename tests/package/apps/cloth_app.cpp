// A sheet of cloth is cut: so far its pattern.
#include <cmath>

#include "app.h"
#include "softpoint/cloth/pattern.h"

int main() {
  const softpoint::cloth::Fabric fabric;
  const auto pattern = softpoint::cloth::square_pattern(50, 50, 0.3, 0.3, fabric);
  double mass = 0;
  for (double m : pattern.masses) mass += m;
  std::printf("mass %.9f kg\n", mass);
  require(std::abs(mass - 0.018) < 1e-12, "mass is density times area");

  require_refusal([&] { softpoint::cloth::square_pattern(1, 2, 1, 1, fabric); }, "columns = 1");
}

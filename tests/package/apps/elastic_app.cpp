// An elastic cube falls on a floor and comes to rest on it.
#include <cmath>

#include "app.h"
#include "softpoint/core/deformable_system.h"
#include "softpoint/core/shapes.h"
#include "softpoint/elastic/elastic_body.h"

int main() {
  namespace elastic = softpoint::elastic;
  elastic::ElasticSettings settings;
  settings.cache.folder.clear();
  const softpoint::TriangleMesh cube = softpoint::box_grid(2, 2, 2, {0.4, 0.4, 0.4});
  const auto model =
      elastic::make_elastic_model(cube, {.young = 1e5, .poisson = 0.3, .density = 500}, settings);

  World scene;
  softpoint::DeformableSystem soft(scene.world);
  elastic::ElasticBody body(model, {0, 0.5, 0});
  soft.add(body);
  scene.step(180);

  double push = 0;
  for (const softpoint::ContactPoint& contact : soft.contacts()) push += contact.force.y();
  const double weight = 9.81 * body.total_mass();
  std::printf("kernels %s\n", elastic::name(model->stiffness->instruction_set));
  std::printf("height %.9f m, push of the floor %.6f N, weight %.6f N\n", body.center_of_mass().y(), push, weight);
  require(std::abs(body.total_mass() - 32.0) < 1e-9, "mass is density times volume");
  require(std::abs(push - weight) < 1e-2 * weight, "the floor bears the weight");
  require(body.center_of_mass().y() < 0.2 + 1e-3 && body.center_of_mass().y() > 0.19, "rest on the floor");

  require_refusal([&] { elastic::make_elastic_model(cube, {.poisson = 0.7}, settings); }, "poisson = 0.7");
}

#pragma once

#include <Eigen/Dense>

#include <map>
#include <memory>
#include <string>
#include <tuple>

#include "softpoint/core/shapes.h"
#include "softpoint/elastic/elastic_body.h"
#include "support/temporary_folder.h"

namespace softpoint {

enum class Shape { ball, part, cube, bar, marble, block, slab };

inline TriangleMesh mesh_of(Shape shape) {
  switch (shape) {
    case Shape::ball:
      return sphere(0.3, 2);  // 162 vertices
    case Shape::part:
      return prism(16, 4, 1, 0.25, 0.5);  // the 82-vertex cylinder
    case Shape::cube:
      return box_grid(2, 2, 2, Vec3(0.4, 0.4, 0.4));  // 26 vertices
    case Shape::marble:
      return sphere(0.12, 2);  // 162 vertices
    case Shape::block:
      return box_grid(2, 2, 2, Vec3(0.15, 0.15, 0.15));  // 26 vertices
    case Shape::slab:
      return box_grid(8, 2, 4, Vec3(0.8, 0.15, 0.4));  // 114 vertices
    case Shape::bar:
      break;
  }
  return box_grid(10, 2, 2, Vec3(1.0, 0.2, 0.2));
}

// Models are made once a program; their stiffness is shared through a cache that lives as long.
inline std::shared_ptr<const elastic::ElasticModel> model_of(Shape shape, double young = 1e5,
                                                             double dt = 1.0 / 60.0, double density = 1000.0,
                                                             double poisson = 0.3) {
  static TemporaryFolder folder;
  static std::map<std::tuple<Shape, double, double, double, double>,
                  std::shared_ptr<const elastic::ElasticModel>>
      known;
  auto& model = known[{shape, young, dt, density, poisson}];
  if (!model) {
    elastic::ElasticSettings settings;
    settings.time_step = dt;
    settings.cache.folder = folder.path().string();
    model = elastic::make_elastic_model(mesh_of(shape), {young, poisson, density}, settings);
  }
  return model;
}

inline double energy_of(const Deformable& body) { return body.kinetic_energy() + body.elastic_energy(); }

}  // namespace softpoint

#include "scene_elastic.h"

#include <memory>
#include <utility>

#include "scene_mesh.h"
#include "softpoint/elastic/elastic_body.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

elastic::Material read_material(ObjectReader& item) {
  elastic::Material material;
  item.object("material", "linear, isotropic, homogeneous", [&](ObjectReader& reader) {
    material.young = reader.number("young", {.quantity = Quantity::kPressure,
                                             .low = elastic::kMinYoung,
                                             .high = elastic::kMaxYoung,
                                             .doc = "Young's modulus"});
    material.poisson = reader.number("poisson", {.low = elastic::kMinPoisson,
                                                 .high = elastic::kMaxPoisson,
                                                 .fallback = material.poisson,
                                                 .doc = "Poisson's ratio"});
    material.density = reader.number("density", {.quantity = Quantity::kDensity,
                                                 .low = elastic::kMinDensity,
                                                 .high = elastic::kMaxDensity,
                                                 .fallback = material.density,
                                                 .doc = "mass per volume"});
  });
  return material;
}

DeformableActor make_elastic(const TriangleMesh& mesh, const elastic::Material& material,
                             const WorldSpec& world, const Placement& placement, const Motion& motion) {
  elastic::ElasticSettings settings;
  settings.time_step = static_cast<btScalar>(world.substep());
  auto body = std::make_unique<elastic::ElasticBody>(elastic::make_elastic_model(mesh, material, settings),
                                                     placement.position, placement.rotation);
  body->set_velocity(motion.linear, motion.angular);
  DeformableActor actor;
  actor.switches["gravity"] = [soft = body.get(), gravity = world.gravity](bool on) {
    soft->set_acceleration(on ? Vec3(Vec3::Zero()) : Vec3(-gravity));
  };
  actor.body = std::move(body);
  return actor;
}

DeformablePlan read_elastic(ObjectReader& item) {
  TriangleMesh mesh = read_mesh(item, "mesh");
  const elastic::Material material = read_material(item);
  DeformablePlan plan;
  plan.vertex_count = mesh.vertex_count();
  plan.make = [mesh = std::move(mesh), material](const WorldSpec& world, const Placement& placement,
                                                 const Motion& motion) {
    return make_elastic(mesh, material, world, placement, motion);
  };
  return plan;
}

}  // namespace

DeformablePlugin elastic_plugin() {
  return {"elastic", "linear elastic solid, boundary elements on its surface", {"gravity"}, read_elastic};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

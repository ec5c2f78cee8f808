#include "scene_elastic.h"

#include <memory>
#include <utility>

#include "scene_material.h"
#include "scene_mesh.h"
#include "softpoint/elastic/elastic_body.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

DeformableActor make_elastic(const TriangleMesh& mesh, const elastic::Material& material,
                             const MakeContext& context) {
  elastic::ElasticSettings settings;
  settings.time_step = static_cast<btScalar>(context.world.substep());
  auto body = std::make_unique<elastic::ElasticBody>(elastic::make_elastic_model(mesh, material, settings),
                                                     context.placement.position, context.placement.rotation);
  body->set_velocity(context.motion.linear, context.motion.angular);
  DeformableActor actor;
  actor.switches["gravity"] = [soft = body.get(), gravity = context.world.gravity](bool on) {
    soft->set_acceleration(on ? Vec3(Vec3::Zero()) : Vec3(-gravity));
  };
  actor.body = std::move(body);
  return actor;
}

DeformablePlan read_elastic(ObjectReader& item, const Scene&) {
  TriangleMesh mesh = read_mesh(item, "mesh");
  const elastic::Material material = read_material(item);
  DeformablePlan plan;
  plan.vertex_count = mesh.vertex_count();
  plan.make = [mesh = std::move(mesh), material](const MakeContext& context) {
    return make_elastic(mesh, material, context);
  };
  return plan;
}

}  // namespace

DeformablePlugin elastic_plugin() {
  return {"elastic", "linear elastic solid, boundary elements on its surface", {"gravity"}, read_elastic};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#include "scene_cloth.h"

#include <memory>
#include <utility>

#include "scene_cloth_parts.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

class ClothSheet final : public Sheet {
 public:
  explicit ClothSheet(const cloth::Cloth& body) : body_(body) {
    TriangleMesh mesh;
    mesh.vertices = body.pattern().points;
    mesh.triangles = body.pattern().faces;
    area_ = surface_area(mesh);
  }

  SheetState measure() const override {
    SheetState state;
    double largest = 0;
    for (const cloth::BubbleState& bubble : body_.bubbles()) {
      if (bubble.open) continue;
      ++state.bubbles;
      state.volume += bubble.volume;
      if (state.bubbles == 1 || bubble.volume > largest) {
        largest = bubble.volume;
        state.gauge = bubble.pressure - body_.air().ambient;
      }
    }
    const cloth::AirBalance balance = body_.air_balance();
    state.air = balance.air;
    state.vented = balance.vented;
    state.audit = balance.audit;
    const cloth::StretchState stretch = body_.stretch();
    state.stretch = stretch.largest;
    state.stretch_99 = stretch.p99;
    state.stretch_mean = stretch.mean;
    state.contact_area = body_.contact_area();
    for (const Vec3& force : body_.contact_forces()) state.contact_force += force.norm();
    state.substeps = body_.profile().counts.substeps;
    state.marched = body_.profile().counts.marched;
    state.air_skipped = body_.profile().counts.air_skipped;
    return state;
  }
  std::span<const double> saturation() const override { return body_.saturation(); }
  double area() const override { return area_; }

 private:
  const cloth::Cloth& body_;
  double area_ = 0;
};

DeformableActor make_cloth(const cloth::ClothDesign& design, const MakeContext& context) {
  auto body = std::make_unique<cloth::Cloth>(design, context.placement.position, context.placement.rotation);
  body->set_velocity(context.motion.linear, context.motion.angular);
  DeformableActor actor;
  cloth::Cloth* const soft = body.get();
  actor.switches["gravity"] = [soft, gravity = context.world.gravity](bool on) {
    soft->set_acceleration(on ? Vec3(Vec3::Zero()) : Vec3(-gravity));
  };
  actor.switches["air"] = [soft, air = design.air](bool on) {
    cloth::AirSettings settings = air;
    if (!on) settings.bubbles = cloth::Bubbles::kOff;
    soft->set_air(settings);
  };
  actor.switches["self_contact"] = [soft, contact = design.self_contact](bool on) {
    cloth::SelfContact settings = contact;
    settings.on = on;
    soft->set_self_contact(settings);
  };
  actor.sheet = std::make_unique<ClothSheet>(*body);
  actor.body = std::move(body);
  return actor;
}

DeformablePlan read_cloth(ObjectReader& item, const Scene&) {
  cloth::ClothDesign design = read_cloth_design(item);
  DeformablePlan plan;
  plan.vertex_count = design.pattern.point_count();
  plan.make = [design = std::move(design)](const MakeContext& context) {
    return make_cloth(design, context);
  };
  return plan;
}

}  // namespace

DeformablePlugin cloth_plugin() {
  return {
      "cloth", "cloth, dry or wet, with the air it traps", {"air", "gravity", "self_contact"}, read_cloth};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

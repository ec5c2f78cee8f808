#include "softpoint/picture/world_painter.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletSoftBody/btSoftBody.h>

#include <optional>
#include <unordered_map>

#include "bullet_vec.h"
#include "shape_meshes.h"
#include "soft_body_meshes.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

class __attribute__((visibility("hidden"))) WorldPainter::Impl {
 public:
  explicit Impl(Renderer& target) : renderer(target), shapes(target), soft_bodies(target) {}

  struct Look {
    std::optional<Material> material;
    std::optional<bool> visible;
    int palette = -1;
  };

  Material material(const btCollisionObject& object) {
    Look& look = looks[&object];
    if (look.material) return *look.material;
    Material material;
    // Bullet's soft bodies carry the flag of static objects although they move.
    if (object.isStaticObject() && !btSoftBody::upcast(&object)) {
      const btCollisionShape* shape = object.getCollisionShape();
      const bool floor = shape && shape->getShapeType() == STATIC_PLANE_PROXYTYPE;
      material.color = floor ? kGroundColor : kStaticColor;
      material.roughness = 0.8;
      return material;
    }
    if (look.palette < 0) look.palette = next_palette++;
    material.color = palette_color(look.palette);
    return material;
  }

  // Sensors and ghosts fill space that other things are seen in.
  bool visible(const btCollisionObject& object) {
    const Look& look = looks[&object];
    return look.visible.value_or(object.hasContactResponse() || look.material.has_value());
  }

  void draw(const btCollisionObject& object);
  void draw_shape(const btCollisionShape& shape, const btTransform& transform, const Material& material);

  Renderer& renderer;
  ShapeMeshes shapes;
  SoftBodyMeshes soft_bodies;
  std::unordered_map<const btCollisionObject*, Look> looks;
  int next_palette = 0;
  WorldStats stats;
};

void WorldPainter::Impl::draw_shape(const btCollisionShape& shape, const btTransform& transform,
                                    const Material& material) {
  const int type = shape.getShapeType();
  if (type == EMPTY_SHAPE_PROXYTYPE) return;
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
      draw_shape(*compound.getChildShape(i), transform * compound.getChildTransform(i), material);
    }
    return;
  }
  if (type == STATIC_PLANE_PROXYTYPE) {
    const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
    const btVector3 normal = transform.getBasis() * plane.getPlaneNormal();
    const btScalar offset = plane.getPlaneConstant() + normal.dot(transform.getOrigin());
    renderer.draw_ground(to_vec3(normal), offset, material.color);
    return;
  }
  const ShapeMesh found = shapes.find(shape);
  if (found.mesh < 0) return;
  Pose pose = to_pose(transform);
  pose.linear = pose.linear * found.stretch;
  Material used = material;
  used.two_sided = used.two_sided || found.open_surface;
  renderer.draw_mesh(found.mesh, used, pose);
}

void WorldPainter::Impl::draw(const btCollisionObject& object) {
  ++stats.objects;
  const btCollisionShape* shape = object.getCollisionShape();
  const Material look = material(object);
  if (!visible(object) || !shape) return;

  const btSoftBody* soft = btSoftBody::upcast(&object);
  if (soft && soft->m_nodes.size() == 0) return;
  btVector3 low, high;
  if (soft) {
    // The body's own bounds lag behind its nodes until its next step.
    low = high = soft->m_nodes[0].m_x;
    for (int i = 1; i < soft->m_nodes.size(); ++i) {
      low.setMin(soft->m_nodes[i].m_x);
      high.setMax(soft->m_nodes[i].m_x);
    }
  } else {
    shape->getAabb(object.getWorldTransform(), low, high);
  }
  if (!renderer.concerns_frame(to_vec3(low), to_vec3(high))) {
    ++stats.objects_skipped;
    return;
  }
  if (soft) {
    soft_bodies.draw(*soft, look);
  } else {
    draw_shape(*shape, object.getWorldTransform(), look);
  }
}

WorldPainter::WorldPainter(Renderer& renderer) : impl_(std::make_unique<Impl>(renderer)) {}
WorldPainter::~WorldPainter() = default;

void WorldPainter::draw(const btCollisionWorld& world) {
  impl_->stats = {};
  impl_->soft_bodies.start_frame();
  const int tessellated_before = impl_->shapes.tessellated();
  const btCollisionObjectArray& objects = world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) impl_->draw(*objects[i]);
  impl_->shapes.end_frame();
  impl_->soft_bodies.end_frame();
  impl_->stats.shapes_tessellated = impl_->shapes.tessellated() - tessellated_before;
  impl_->stats.shapes_kept = impl_->shapes.kept();
  impl_->stats.soft_bodies_moved = impl_->soft_bodies.moved();
  impl_->stats.soft_bodies_at_rest = impl_->soft_bodies.at_rest();
}

void WorldPainter::set_material(const btCollisionObject& object, const Material& material) {
  check(material);
  impl_->looks[&object].material = material;
}

void WorldPainter::set_visible(const btCollisionObject& object, bool visible) {
  impl_->looks[&object].visible = visible;
}

void WorldPainter::forget(const btCollisionObject& object) { impl_->looks.erase(&object); }

Material WorldPainter::material(const btCollisionObject& object) { return impl_->material(object); }

const WorldStats& WorldPainter::stats() const { return impl_->stats; }

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

#include "softpoint/picture/debug_drawer.h"

#include "bullet_vec.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

DebugDrawer::DebugDrawer(const DebugStyle& style) : style_(style) {
  check_range("debug line_pixels", style.line_pixels, 0.1, 1000.0);
  check_range("debug contact_pixels", style.contact_pixels, 0.1, 1000.0);
  check_range("debug contact_length", style.contact_length, 0.0, 1e6);
  // Bullet's own defaults are made for a black background.
  colors_.m_activeObject = btVector3(btScalar(0.10), btScalar(0.22), btScalar(0.50));
  colors_.m_deactivatedObject = btVector3(btScalar(0.15), btScalar(0.45), btScalar(0.25));
  colors_.m_wantsDeactivationObject = btVector3(btScalar(0.10), btScalar(0.45), btScalar(0.50));
  colors_.m_disabledDeactivationObject = btVector3(btScalar(0.55), btScalar(0.12), btScalar(0.12));
  colors_.m_disabledSimulationObject = btVector3(btScalar(0.50), btScalar(0.42), btScalar(0.10));
  colors_.m_aabb = btVector3(btScalar(0.70), btScalar(0.25), btScalar(0.15));
  colors_.m_contactPoint = btVector3(btScalar(0.90), btScalar(0.55), btScalar(0.05));
}

void DebugDrawer::clear() {
  lines_.clear();
  triangles_.clear();
  contacts_.clear();
  texts_.clear();
}

void DebugDrawer::drawLine(const btVector3& from, const btVector3& to, const btVector3& color) {
  lines_.push_back({to_vec3(from), to_vec3(to), to_color(color)});
}

void DebugDrawer::drawTriangle(const btVector3& a, const btVector3& b, const btVector3& c,
                               const btVector3& color, btScalar opacity) {
  triangles_.push_back({to_vec3(a), to_vec3(b), to_vec3(c), to_color(color, static_cast<float>(opacity))});
}

void DebugDrawer::drawContactPoint(const btVector3& point, const btVector3& normal, btScalar /*distance*/,
                                   int /*life_time*/, const btVector3& color) {
  contacts_.push_back({to_vec3(point), to_vec3(normal), to_color(color)});
}

void DebugDrawer::draw3dText(const btVector3& place, const char* text) {
  texts_.push_back({to_vec3(place), text});
}

void DebugDrawer::reportErrorWarning(const char* warning) {
  if (warnings_.size() < 100) warnings_.emplace_back(warning);
}

void DebugDrawer::draw(Renderer& renderer) const {
  for (const FlatTriangle& t : triangles_) renderer.draw_triangle(t.a, t.b, t.c, t.color);
  for (const Line& line : lines_) {
    renderer.draw_line(line.from, line.to, line.color, style_.line_pixels, style_.see_through);
  }
  for (const Contact& contact : contacts_) {
    renderer.draw_point(contact.point, contact.color, style_.contact_pixels, style_.see_through);
    renderer.draw_arrow(contact.point, contact.normal * style_.contact_length, contact.color,
                        0.06 * style_.contact_length);
  }
  TextStyle text_style;
  text_style.scale = 0.9;
  for (const Text& text : texts_) renderer.draw_label(text.place, text.text, text_style);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

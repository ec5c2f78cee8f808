#pragma once

#include <LinearMath/btIDebugDraw.h>

#include <string>
#include <vector>

#include "softpoint/picture/renderer.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// How debug drawing looks.
struct DebugStyle {
  double line_pixels = 1.2;      // width of lines, 0.1 to 1000
  double contact_pixels = 3.5;   // radius of a contact point, 0.1 to 1000
  double contact_length = 0.08;  // metres, the arrow along a contact's normal; 0 for none, up to 1e6
  bool see_through = true;       // lines and points also show behind solids
};

// Bullet's debug drawing, collected and then drawn by a Renderer:
//   world.setDebugDrawer(&drawer); world.debugDrawWorld(); drawer.draw(renderer);
// Starts in mode DBG_DrawWireframe. Bullet empties the drawer at each debugDrawWorld().
class SOFTPOINT_API DebugDrawer final : public btIDebugDraw {
 public:
  // Empty.
  explicit DebugDrawer(const DebugStyle& style = {});

  // Between renderer.begin() and renderer.finish(); keeps what was collected.
  void draw(Renderer& renderer) const;
  // Forgets what was collected, but not the warnings.
  void clear();

  // How much was collected.
  // @{
  int line_count() const { return static_cast<int>(lines_.size()); }
  int triangle_count() const { return static_cast<int>(triangles_.size()); }
  int contact_count() const { return static_cast<int>(contacts_.size()); }
  int text_count() const { return static_cast<int>(texts_.size()); }
  // @}
  // The first hundred since construction.
  const std::vector<std::string>& warnings() const { return warnings_; }

  using btIDebugDraw::drawLine;
  using btIDebugDraw::drawTriangle;
  // What Bullet calls.
  // @{
  void drawLine(const btVector3& from, const btVector3& to, const btVector3& color) override;
  void drawTriangle(const btVector3& a, const btVector3& b, const btVector3& c, const btVector3& color,
                    btScalar opacity) override;
  void drawContactPoint(const btVector3& point, const btVector3& normal, btScalar distance, int life_time,
                        const btVector3& color) override;
  void draw3dText(const btVector3& place, const char* text) override;
  void reportErrorWarning(const char* warning) override;
  void clearLines() override { clear(); }
  DefaultColors getDefaultColors() const override { return colors_; }
  void setDefaultColors(const DefaultColors& colors) override { colors_ = colors; }
  void setDebugMode(int mode) override { mode_ = mode; }
  int getDebugMode() const override { return mode_; }
  // @}

 private:
  struct Line {
    Vec3 from, to;
    Color color;
  };
  struct FlatTriangle {
    Vec3 a, b, c;
    Color color;
  };
  struct Contact {
    Vec3 point, normal;
    Color color;
  };
  struct Text {
    Vec3 place;
    std::string text;
  };

  DebugStyle style_;
  int mode_ = DBG_DrawWireframe;
  DefaultColors colors_;
  std::vector<Line> lines_;
  std::vector<FlatTriangle> triangles_;
  std::vector<Contact> contacts_;
  std::vector<Text> texts_;
  std::vector<std::string> warnings_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

#pragma once

#include <array>
#include <vector>

#include "player.h"
#include "softpoint/picture/renderer.h"
#include "softpoint/picture/world_painter.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Draws the deformables of a scene that are not of one colour all over: bodies of parts, whose segments
// alternate, cloths, which are darker and shine where they are wet, and those that show their edges alone.
// Takes them out of the painter's hands.
class PiecePainter {
 public:
  PiecePainter(const Player& player, picture::Renderer& renderer, picture::WorldPainter& painter);

  // Between renderer.begin() and renderer.finish().
  void draw();

 private:
  struct Mesh {  // all pieces of one colour
    std::size_t body = 0;
    picture::Color color;
    std::vector<int> points;  // of the body
    int mesh = -1;
    double wetness = 0;
    bool two_sided = false;
  };
  struct Edges {
    std::size_t body = 0;
    picture::Color color;
    std::vector<std::array<int, 2>> edges;
  };

  static std::vector<Triangle> with_points_of(Mesh& mesh, const std::vector<Triangle>& triangles);
  void add_pieces(std::size_t body, picture::Color own);
  void add_sheet(std::size_t body, picture::Color own);
  void add_edges(std::size_t body, picture::Color own);

  const Player& player_;
  picture::Renderer& renderer_;
  std::vector<Mesh> meshes_;
  std::vector<Edges> edges_;
  std::vector<Vec3> vertices_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

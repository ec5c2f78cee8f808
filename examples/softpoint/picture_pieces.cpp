#include "picture_pieces.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr double kCrease = 50.0;    // degrees: prisms of eight sides look round
constexpr double kFlat = 1e-6;      // 1 - cosine of the angle between faces of a flat quad
constexpr float kLighter = 0.55F;   // towards white
constexpr double kEdgeWidth = 2.0;  // pixels
constexpr double kFold = 80.0;      // degrees: cloth has no edges but its folds
constexpr int kShades = 8;          // of wetness

picture::Color rgb_color(const Vec3& rgb) {
  return {static_cast<float>(rgb.x()), static_cast<float>(rgb.y()), static_cast<float>(rgb.z())};
}

picture::Color lightened(picture::Color color) {
  for (float* c : {&color.r, &color.g, &color.b}) *c += kLighter * (1.0F - *c);
  return color;
}

// Edges without the diagonals of flat quads.
std::vector<std::array<int, 2>> quad_edges(const Deformable& body) {
  const auto points = body.points();
  const auto at = [&](int v) -> const Vec3& { return points[static_cast<std::size_t>(v)]; };
  const auto faces = body.faces();
  std::map<std::array<int, 2>, std::vector<std::size_t>> around;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = faces[f][k], b = faces[f][(k + 1) % 3];
      around[{std::min(a, b), std::max(a, b)}].push_back(f);
    }
  }
  const auto normal = [&](std::size_t f) {
    return (at(faces[f][1]) - at(faces[f][0])).cross(at(faces[f][2]) - at(faces[f][0])).normalized();
  };
  const auto longest = [&](std::size_t f) {
    double length = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      length = std::max(length, (at(faces[f][k]) - at(faces[f][(k + 1) % 3])).norm());
    }
    return length;
  };
  std::vector<std::array<int, 2>> edges;
  for (const auto& [edge, f] : around) {
    const double length = (at(edge[0]) - at(edge[1])).norm();
    const bool diagonal = f.size() == 2 && 1.0 - normal(f[0]).dot(normal(f[1])) < kFlat &&
                          length > 0.999 * longest(f[0]) && length > 0.999 * longest(f[1]);
    if (!diagonal) edges.push_back(edge);
  }
  return edges;
}

}  // namespace

PiecePainter::PiecePainter(const Player& player, picture::Renderer& renderer, picture::WorldPainter& painter)
    : player_(player), renderer_(renderer) {
  for (std::size_t k = 0; k < player.deformable_count(); ++k) {
    const DeformableSpec& spec = player.scene().deformables[k];
    const picture::Color own =
        spec.color ? rgb_color(*spec.color) : painter.material(player.deformable(k)).color;
    const bool parts = player.articulation(k) != nullptr, sheet = player.sheet(k) != nullptr;
    if (spec.look == Look::kSolid && !parts && !sheet) continue;
    painter.set_visible(player.deformable(k), false);
    if (spec.look == Look::kSolid && parts) add_pieces(k, own);
    if (spec.look == Look::kSolid && sheet) add_sheet(k, own);
    if (spec.look == Look::kEdges) add_edges(k, own);
  }
}

// The triangles between points of the mesh, to which the ones they have are added.
std::vector<Triangle> PiecePainter::with_points_of(Mesh& mesh, const std::vector<Triangle>& triangles) {
  std::map<int, int> renamed;
  std::vector<Triangle> result;
  for (Triangle t : triangles) {
    for (int& v : t) {
      const auto [entry, is_new] = renamed.try_emplace(v, static_cast<int>(mesh.points.size()));
      if (is_new) mesh.points.push_back(v);
      v = entry->second;
    }
    result.push_back(t);
  }
  return result;
}

void PiecePainter::add_pieces(std::size_t body, picture::Color own) {
  const auto points = player_.deformable(body).points();
  std::map<std::array<float, 3>, std::vector<const Piece*>> by_color;
  for (const Piece& piece : player_.articulation(body)->pieces()) {
    const picture::Color plain = piece.color ? rgb_color(*piece.color) : own;
    const picture::Color color = piece.lighter ? lightened(plain) : plain;
    by_color[{color.r, color.g, color.b}].push_back(&piece);
  }
  for (const auto& [color, pieces] : by_color) {
    Mesh mesh{body, {color[0], color[1], color[2]}, {}, -1, 0, false};
    std::vector<Triangle> triangles;
    std::vector<Vec3> vertices;
    for (const Piece* piece : pieces) {
      // Seams stay sharp: a piece's points are its own.
      const std::vector<Triangle> own_points = with_points_of(mesh, piece->faces);
      triangles.insert(triangles.end(), own_points.begin(), own_points.end());
    }
    if (triangles.empty()) continue;
    for (const int p : mesh.points) vertices.push_back(points[static_cast<std::size_t>(p)]);
    mesh.mesh = renderer_.add_mesh(vertices, triangles, kCrease);
    meshes_.push_back(std::move(mesh));
  }
}

// A mesh for each of a few shades of wetness: water is painted on points, faces have the mean of theirs.
void PiecePainter::add_sheet(std::size_t body, picture::Color own) {
  const auto points = player_.deformable(body).points();
  const auto saturation = player_.sheet(body)->saturation();
  std::map<int, std::vector<Triangle>> by_shade;
  for (const Triangle& t : player_.deformable(body).faces()) {
    double sum = 0;
    for (const int v : t) sum += saturation.empty() ? 0.0 : saturation[static_cast<std::size_t>(v)];
    by_shade[static_cast<int>(std::lround(sum / 3 * kShades))].push_back(t);
  }
  for (const auto& [shade, triangles] : by_shade) {
    Mesh mesh{body, own, {}, -1, static_cast<double>(shade) / kShades, true};
    const std::vector<Triangle> renamed = with_points_of(mesh, triangles);
    std::vector<Vec3> vertices;
    for (const int p : mesh.points) vertices.push_back(points[static_cast<std::size_t>(p)]);
    mesh.mesh = renderer_.add_mesh(vertices, renamed, kFold);
    meshes_.push_back(std::move(mesh));
  }
}

void PiecePainter::add_edges(std::size_t body, picture::Color own) {
  edges_.push_back({body, own, quad_edges(player_.deformable(body))});
}

void PiecePainter::draw() {
  for (const Mesh& mesh : meshes_) {
    if (!player_.present({true, static_cast<int>(mesh.body)})) continue;
    const auto points = player_.deformable(mesh.body).points();
    vertices_.clear();
    for (const int p : mesh.points) vertices_.push_back(points[static_cast<std::size_t>(p)]);
    renderer_.update_mesh(mesh.mesh, vertices_);
    picture::Material material;
    material.color = mesh.color;
    material.wireframe = player_.overlays().wireframe;
    material.wetness = mesh.wetness;
    material.two_sided = mesh.two_sided;
    renderer_.draw_mesh(mesh.mesh, material);
  }
  for (const Edges& body : edges_) {
    if (!player_.present({true, static_cast<int>(body.body)})) continue;
    const auto points = player_.deformable(body.body).points();
    for (const auto& edge : body.edges) {
      renderer_.draw_line(points[static_cast<std::size_t>(edge[0])],
                          points[static_cast<std::size_t>(edge[1])], body.color, kEdgeWidth);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

#include "soft_body_meshes.h"

#include <BulletSoftBody/btSoftBody.h>

#include <cstddef>

#include "bullet_vec.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

constexpr std::uint64_t kBodyFramesKept = 128;
// Round things are often coarse prisms of six or eight sides; a cube's edges stay sharp.
constexpr double kCreaseDegrees = 65.0;

long long node_index(const btSoftBody& body, const btSoftBody::Node* node) { return node - &body.m_nodes[0]; }

// Tells apart bodies of other faces at the same address.
std::uint64_t topology_of(const btSoftBody& body) {
  std::uint64_t value = 14695981039346656037ULL;
  const auto take = [&value](std::uint64_t word) { value = (value ^ word) * 1099511628211ULL; };
  take(static_cast<std::uint64_t>(body.m_nodes.size()));
  for (int f = 0; f < body.m_faces.size(); ++f) {
    for (const btSoftBody::Node* node : body.m_faces[f].m_n) {
      take(static_cast<std::uint64_t>(node_index(body, node)));
    }
  }
  return value;
}

}  // namespace

SoftBodyMeshes::~SoftBodyMeshes() {
  for (const auto& [body, entry] : entries_) {
    if (entry.mesh >= 0) renderer_.remove_mesh(entry.mesh);
  }
}

void SoftBodyMeshes::draw(const btSoftBody& body, Material material) {
  material.two_sided = true;  // the body may be a sheet
  if (body.m_faces.size() > 0) {
    draw_faces(body, material);
  } else if (body.m_links.size() > 0) {
    draw_links(body, material);
  } else {
    for (int i = 0; i < body.m_nodes.size(); ++i) {
      renderer_.draw_point(to_vec3(body.m_nodes[i].m_x), material.color, 3.0);
    }
  }
}

void SoftBodyMeshes::draw_links(const btSoftBody& body, const Material& material) {
  for (int i = 0; i < body.m_links.size(); ++i) {
    const btSoftBody::Link& link = body.m_links[i];
    renderer_.draw_line(to_vec3(link.m_n[0]->m_x), to_vec3(link.m_n[1]->m_x), material.color, 2.0);
  }
}

// True if any differs from what `positions` held.
bool SoftBodyMeshes::take_positions(const btSoftBody& body, std::vector<Vec3>& positions) {
  const auto count = static_cast<std::size_t>(body.m_nodes.size());
  bool changed = positions.size() != count;
  positions.resize(count, Vec3::Zero());
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 now = to_vec3(body.m_nodes[static_cast<int>(i)].m_x);
    changed = changed || now != positions[i];
    positions[i] = now;
  }
  return changed;
}

void SoftBodyMeshes::place(Entry& entry) {
  entry.origin = entry.positions.front();
  relative_.resize(entry.positions.size());
  for (std::size_t i = 0; i < relative_.size(); ++i) relative_[i] = entry.positions[i] - entry.origin;
}

void SoftBodyMeshes::rebuild(const btSoftBody& body, Entry& entry) {
  if (entry.mesh >= 0) renderer_.remove_mesh(entry.mesh);
  entry.mesh = -1;
  place(entry);
  for (const Vec3& p : relative_) {
    if (!p.allFinite()) return;  // the next frame tries again
  }
  std::vector<Triangle> triangles(static_cast<std::size_t>(body.m_faces.size()));
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      triangles[f][k] = static_cast<int>(node_index(body, body.m_faces[static_cast<int>(f)].m_n[k]));
    }
  }
  entry.mesh = renderer_.add_mesh(relative_, triangles, kCreaseDegrees);
}

void SoftBodyMeshes::draw_faces(const btSoftBody& body, const Material& material) {
  const auto [found, is_new] = entries_.try_emplace(&body);
  Entry& entry = found->second;
  entry.used = frame_;
  const std::uint64_t topology = topology_of(body);
  const bool changed = take_positions(body, entry.positions);
  ++(changed ? moved_ : at_rest_);
  if (entry.mesh < 0 || entry.topology != topology) {
    entry.topology = topology;
    rebuild(body, entry);
  } else if (changed) {
    place(entry);
    renderer_.update_mesh(entry.mesh, relative_);
  }
  if (entry.mesh < 0) return;
  Pose pose;
  pose.origin = entry.origin;
  renderer_.draw_mesh(entry.mesh, material, pose);
}

void SoftBodyMeshes::end_frame() {
  if (++frame_ % kBodyFramesKept != 0) return;
  std::erase_if(entries_, [this](const auto& item) {
    if (item.second.used + kBodyFramesKept >= frame_) return false;
    if (item.second.mesh >= 0) renderer_.remove_mesh(item.second.mesh);
    return true;
  });
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

#include "mesh_store.h"

#include <cstddef>
#include <string>
#include <utility>

#include "gl/stream_buffer.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

MeshStore::~MeshStore() {
  for (const auto& slot : slots_) {
    if (slot) release(*slot);
  }
}

int MeshStore::add(SmoothMesh mesh) {
  auto slot = std::make_unique<Slot>(std::move(mesh));
  if (free_.empty()) {
    slots_.push_back(std::move(slot));
    return static_cast<int>(slots_.size()) - 1;
  }
  const int index = free_.back();
  free_.pop_back();
  slots_[static_cast<std::size_t>(index)] = std::move(slot);
  return index;
}

MeshStore::Slot& MeshStore::slot(int mesh) const {
  check_index("mesh", mesh, static_cast<long long>(slots_.size()));
  Slot* found = slots_[static_cast<std::size_t>(mesh)].get();
  if (!found || found->removed) throw Error("mesh = " + std::to_string(mesh) + ": it was removed");
  return *found;
}

const SmoothMesh& MeshStore::at(int mesh) const { return slot(mesh).mesh; }

void MeshStore::move(int mesh, std::span<const Vec3> vertices) {
  Slot& moved = slot(mesh);
  moved.mesh.move(vertices);
  moved.stale = true;
}

void MeshStore::remove(int mesh) {
  slot(mesh).removed = true;
  removed_.push_back(mesh);
}

void MeshStore::release(Slot& slot) const {
  gl_.DeleteVertexArrays(1, &slot.array);
  const GLuint buffers[] = {slot.vertices, slot.indices};
  gl_.DeleteBuffers(2, buffers);
}

void MeshStore::release_removed() {
  for (const int mesh : removed_) {
    std::unique_ptr<Slot>& removed = slots_[static_cast<std::size_t>(mesh)];
    release(*removed);
    removed.reset();
    free_.push_back(mesh);
  }
  removed_.clear();
}

bool MeshStore::upload(int mesh) {
  Slot& s = *slots_[static_cast<std::size_t>(mesh)];
  if (!s.stale) return false;
  s.stale = false;
  const std::vector<float>& data = s.mesh.vertex_data();
  const auto bytes = static_cast<GLsizeiptr>(data.size() * sizeof(float));
  if (s.array != 0) {
    gl_.BindBuffer(GL_ARRAY_BUFFER, s.vertices);
    gl_.BufferSubData(GL_ARRAY_BUFFER, 0, bytes, data.data());
    return true;
  }
  gl_.GenVertexArrays(1, &s.array);
  gl_.BindVertexArray(s.array);
  gl_.GenBuffers(1, &s.vertices);
  gl_.BindBuffer(GL_ARRAY_BUFFER, s.vertices);
  gl_.BufferData(GL_ARRAY_BUFFER, bytes, data.data(), GL_DYNAMIC_DRAW);
  constexpr std::size_t kStride = SmoothMesh::kFloatsPerVertex * sizeof(float);
  set_attribute(gl_, 0, 3, kStride, 0, 0);
  set_attribute(gl_, 1, 3, kStride, 3 * sizeof(float), 0);
  gl_.GenBuffers(1, &s.indices);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, s.indices);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER,
                 static_cast<GLsizeiptr>(s.mesh.indices().size() * sizeof(std::uint32_t)),
                 s.mesh.indices().data(), GL_STATIC_DRAW);
  return true;
}

void MeshStore::draw(int mesh, GLuint instances, int first, int count) const {
  const Slot& s = *slots_[static_cast<std::size_t>(mesh)];
  gl_.BindVertexArray(s.array);
  gl_.BindBuffer(GL_ARRAY_BUFFER, instances);
  // OpenGL 3.3 has no base instance: the attributes are pointed at the first one instead.
  constexpr std::size_t kStride = sizeof(MeshInstance);
  const std::size_t base = kStride * static_cast<std::size_t>(first);
  for (GLuint row = 0; row < 3; ++row) {
    set_attribute(gl_, 2 + row, 4, kStride, base + offsetof(MeshInstance, rows) + 4 * sizeof(float) * row, 1);
  }
  set_attribute(gl_, 5, 4, kStride, base + offsetof(MeshInstance, color_roughness), 1);
  set_attribute(gl_, 6, 1, kStride, base + offsetof(MeshInstance, wetness), 1);
  gl_.DrawElementsInstanced(GL_TRIANGLES, static_cast<GLsizei>(s.mesh.indices().size()), GL_UNSIGNED_INT,
                            nullptr, count);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

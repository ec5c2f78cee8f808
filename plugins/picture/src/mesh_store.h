#pragma once

#include <memory>
#include <vector>

#include "gl/api.h"
#include "smooth_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// What one drawn copy of a mesh adds to it; attributes 2 to 6 of shaders/mesh.h.
struct MeshInstance {
  float rows[12];            // affine map to eye-relative coordinates, row by row
  float color_roughness[4];  // linear colour
  float wetness;
};

// The meshes of one renderer: the truth on our side, a copy in the driver made when a mesh is first drawn.
class MeshStore {
 public:
  explicit MeshStore(const GlApi& gl) : gl_(gl) {}
  MeshStore(const MeshStore&) = delete;
  MeshStore& operator=(const MeshStore&) = delete;
  ~MeshStore();

  // These need no current context.
  int add(SmoothMesh mesh);
  void move(int mesh, std::span<const Vec3> vertices);
  // The number is free again after the next release_removed(): until then a frame may still draw it.
  void remove(int mesh);
  // Throws Error when there is no such mesh.
  const SmoothMesh& at(int mesh) const;
  // One that the frame has drawn already, perhaps removed since.
  const SmoothMesh& drawn(int mesh) const { return slots_[static_cast<std::size_t>(mesh)]->mesh; }

  // These do.
  void release_removed();
  // True if there was something to upload.
  bool upload(int mesh);
  // `count` instances from `first` on of the MeshInstances in `instances`.
  void draw(int mesh, GLuint instances, int first, int count) const;

 private:
  struct Slot {
    explicit Slot(SmoothMesh m) : mesh(std::move(m)) {}
    SmoothMesh mesh;
    GLuint array = 0, vertices = 0, indices = 0;
    bool stale = true, removed = false;
  };
  Slot& slot(int mesh) const;
  void release(Slot& slot) const;

  const GlApi& gl_;
  std::vector<std::unique_ptr<Slot>> slots_;  // null where free
  std::vector<int> free_;
  std::vector<int> removed_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "softpoint/core/vec.h"
#include "softpoint/picture/renderer.h"

class btSoftBody;

namespace softpoint::inline SOFTPOINT_ABI::picture {

// The meshes of soft bodies, which move by their vertices.
class SoftBodyMeshes {
 public:
  explicit SoftBodyMeshes(Renderer& renderer) : renderer_(renderer) {}
  SoftBodyMeshes(const SoftBodyMeshes&) = delete;
  SoftBodyMeshes& operator=(const SoftBodyMeshes&) = delete;
  ~SoftBodyMeshes();

  void draw(const btSoftBody& body, Material material);
  void end_frame();

  int moved() const { return moved_; }  // of the frame
  int at_rest() const { return at_rest_; }
  void start_frame() { moved_ = at_rest_ = 0; }

 private:
  struct Entry {
    int mesh = -1;
    std::uint64_t topology = 0;
    Vec3 origin{0, 0, 0};         // the vertices are kept relative to it, in single precision
    std::vector<Vec3> positions;  // world
    std::uint64_t used = 0;
  };

  void draw_faces(const btSoftBody& body, const Material& material);
  void draw_links(const btSoftBody& body, const Material& material);
  static bool take_positions(const btSoftBody& body, std::vector<Vec3>& positions);
  void rebuild(const btSoftBody& body, Entry& entry);
  void place(Entry& entry);

  Renderer& renderer_;
  std::unordered_map<const btSoftBody*, Entry> entries_;
  std::vector<Vec3> relative_;  // scratch
  std::uint64_t frame_ = 0;
  int moved_ = 0, at_rest_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

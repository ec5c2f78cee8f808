// OBJ files: read, checked, written and read back.
#include "fuzz/fuzz_support.h"
#include "softpoint/core/error.h"
#include "softpoint/core/obj.h"

using namespace softpoint;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 1 << 16) return 0;
  const fuzz::MemoryFile file({reinterpret_cast<const char*>(data), size});
  TriangleMesh mesh;
  try {
    mesh = read_obj(file.path());
  } catch (const Error&) {
    return 0;
  }
  for (const Triangle& triangle : mesh.triangles) {
    for (const int v : triangle) {
      fuzz::require(v >= 0 && v < mesh.vertex_count(), "a face names vertices that are there");
    }
  }
  for (const Vec3& vertex : mesh.vertices) fuzz::require(vertex.allFinite(), "vertices are finite");
  try {
    check_surface(mesh);
    const MeshReport report = check_closed(mesh);
    fuzz::require(report.volume > 0 && report.bodies > 0, "a closed mesh holds a volume");
  } catch (const Error&) {
  }
  return 0;
}

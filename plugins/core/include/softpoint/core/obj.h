#pragma once

#include <filesystem>

#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Read the vertices and faces of a Wavefront OBJ file (metres, no conversion). Polygons become fans
// of triangles round their first corner; groups, normals, texture coordinates and materials are
// skipped. The result is not checked further: call check_closed or check_surface on it.
// Throws Error with the file and the line for: a file that cannot be read, one without vertices or
// faces, coordinates that are no finite numbers, corners that name no vertex, polygons of fewer than
// three corners. The number format does not depend on the locale.
SOFTPOINT_API TriangleMesh read_obj(const std::filesystem::path& path);

// Write vertices and triangles so that read_obj gives back the same doubles. The file appears whole
// or not at all. Throws Error if it cannot be written.
SOFTPOINT_API void write_obj(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace softpoint::inline SOFTPOINT_ABI

#include "memory.h"

#include <cstdio>
#include <fstream>
#include <limits>
#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

std::string gigabytes(double bytes) {
  char text[40];
  std::snprintf(text, sizeof text, bytes < 1e8 ? "%.4f GB" : "%.1f GB", bytes * 1e-9);
  return text;
}

}  // namespace

double available_memory() {
  std::ifstream file("/proc/meminfo");
  std::string word;
  while (file >> word) {
    double kibibytes = 0.0;
    if (word == "MemAvailable:" && file >> kibibytes) return 1024.0 * kibibytes;
  }
  return std::numeric_limits<double>::infinity();
}

void check_memory(const TriangleMesh& mesh, double bytes, double limit) {
  const double available = limit > 0.0 ? limit : available_memory();
  if (bytes > available) {
    throw Error("mesh of " + std::to_string(mesh.vertex_count()) + " vertices and " +
                std::to_string(mesh.triangle_count()) + " triangles: needs " + gigabytes(bytes) +
                " of memory, permitted is at most " + gigabytes(available) +
                (limit > 0.0 ? " (settings.memory_limit = " + to_text(limit) + " bytes)" : "") +
                "; use fewer triangles (memory grows with their square)");
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic

// Files of the stiffness cache. An input is a list of changes to a good file, a line each:
//   raw <bytes>        the rest of the input is the whole file
//   cut <length>       the file ends there
//   set <at> <byte>    numbers in decimal
//   add <byte>         at the end
// Whatever is changed, the reader must notice.
#include <sstream>

#include "cache_file.h"
#include "fuzz/fuzz_support.h"
#include "softpoint/core/shapes.h"

using namespace softpoint;

namespace {

struct Good {
  elastic::BoundaryStiffness model;
  std::string key, content;

  Good() {
    model.mesh = box_grid(1, 1, 1, Vec3(1, 1, 1));
    model.poisson = 0.3;
    model.quadrature = elastic::Quadrature().resolved(8);
    model.unit_stiffness.assign(24 * 24, 0.25);
    model.gravity_columns.assign(24 * 3, -1.0);
    key = elastic::cache_key(model, false);
    const std::filesystem::path folder = std::filesystem::temp_directory_path();
    const auto file = folder / ("softpoint-fuzz-" + std::to_string(::getpid()) + ".stiffness");
    fuzz::require(elastic::write_cache_file(file, key, model), "a cache file can be written");
    std::FILE* in = std::fopen(file.c_str(), "rb");
    for (int c = std::fgetc(in); c != EOF; c = std::fgetc(in)) content += static_cast<char>(c);
    std::fclose(in);
    std::filesystem::remove(file);
  }
};

std::string changed(const std::string& good, const std::string& changes) {
  std::string content = good;
  std::istringstream lines(changes);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string what;
    std::size_t a = 0, b = 0;
    words >> what >> a >> b;
    if (what == "raw") {
      const auto at = changes.find("raw ");
      return changes.substr(at + 4);
    }
    if (what == "cut" && a < content.size()) content.resize(a);
    if (what == "set" && a < content.size()) content[a] = static_cast<char>(b);
    if (what == "add" && content.size() < good.size() + 64) content += static_cast<char>(a);
  }
  return content;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Good good;
  if (size > 1 << 14) return 0;
  const std::string content = changed(good.content, std::string(reinterpret_cast<const char*>(data), size));
  const fuzz::MemoryFile file(content);
  elastic::BoundaryStiffness model;
  model.mesh = good.model.mesh;
  model.poisson = good.model.poisson;
  model.quadrature = good.model.quadrature;
  const elastic::CacheRead read = elastic::read_cache_file(file.path(), good.key, false, model);
  fuzz::require((read == elastic::CacheRead::kFound) == (content == good.content), "every change is noticed");
  if (read == elastic::CacheRead::kFound) {
    fuzz::require(model.unit_stiffness == good.model.unit_stiffness, "a good file gives its numbers");
  }
  return 0;
}

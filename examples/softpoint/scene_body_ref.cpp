#include "scene_body_ref.h"

#include <fmt/format.h>

#include "json_reader_state.h"
#include "nearest.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

BodyRef find_body(ObjectReader& item, std::string_view key, const std::string& name, const Scene& scene,
                  bool deformables_only) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < scene.deformables.size(); ++k) {
    if (scene.deformables[k].name == name) {
      return {true, static_cast<int>(k)};
    }
    names.push_back(scene.deformables[k].name);
  }
  for (std::size_t k = 0; k < scene.rigid_bodies.size() && !deformables_only; ++k) {
    if (scene.rigid_bodies[k].name == name) {
      return {false, static_cast<int>(k)};
    }
    names.push_back(scene.rigid_bodies[k].name);
  }
  const std::string meant = nearest(name, names);
  item.refuse(key, fmt::format("no {} of that name; {}{}", deformables_only ? "deformable" : "body",
                               names.empty() ? "there are none" : "permitted are " + joined(names),
                               meant.empty() ? "" : "; did you mean \"" + meant + "\"?"));
}

}  // namespace

BodyRef read_body_ref(ObjectReader& item, std::string_view key, const Scene& scene, bool deformables_only,
                      const std::string& doc) {
  const std::string name = item.text(key, {.doc = doc});
  return item.describing() ? BodyRef{} : find_body(item, key, name, scene, deformables_only);
}

std::optional<BodyRef> read_optional_body_ref(ObjectReader& item, std::string_view key, const Scene& scene,
                                              const std::string& doc) {
  const std::string name = item.text(key, {.fallback = "", .doc = doc});
  if (!item.has(key)) {
    return std::nullopt;
  }
  return find_body(item, key, name, scene, false);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

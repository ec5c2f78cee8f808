#pragma once

#include <filesystem>

#include "json_reader.h"
#include "scene.h"
#include "scene_plugins.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// The reader of SCENE.json: every key of it, checked, before anything runs.
void read_scene(ObjectReader& root, const DeformablePlugins& plugins, Scene& scene);

// Throws Error for whatever the file, or a mesh it names, does wrong.
Scene read_scene(const std::filesystem::path& path);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

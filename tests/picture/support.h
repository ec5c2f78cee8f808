#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "softpoint/core/error.h"
#include "softpoint/core/triangle_mesh.h"
#include "softpoint/picture/renderer.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// A small picture on plain white, so that whatever is drawn stands out.
inline RenderSettings plain_settings(int width = 160, int height = 120) {
  RenderSettings settings;
  settings.width = width;
  settings.height = height;
  settings.sky = false;
  settings.shadows = false;
  settings.shadow_resolution = 512;
  settings.background = {1, 1, 1};
  return settings;
}

// Looks along -z at the origin from `distance` metres.
inline Camera front_camera(double distance, double fov_degrees = 40) {
  Camera camera;
  camera.eye = {0, 0, distance};
  camera.target = {0, 0, 0};
  camera.vertical_fov_degrees = fov_degrees;
  return camera;
}

template <class Wanted>
int count_pixels(const Image& image, Wanted wanted) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) count += wanted(image.pixel(x, y)) ? 1 : 0;
  }
  return count;
}

inline bool is_white(const std::uint8_t* p) { return p[0] == 255 && p[1] == 255 && p[2] == 255; }

inline int brightness(const std::uint8_t* p) { return p[0] + p[1] + p[2]; }

inline int count_drawn(const Image& image) {
  return count_pixels(image, [](const std::uint8_t* p) { return !is_white(p); });
}

inline int count_different(const Image& a, const Image& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    count += std::equal(&a.rgba[i], &a.rgba[i] + 4, &b.rgba[i]) ? 0 : 1;
  }
  return count;
}

inline int add(Renderer& renderer, const TriangleMesh& mesh) {
  return renderer.add_mesh(mesh.vertices, mesh.triangles);
}

inline Pose placed(const Vec3& origin, double scale = 1) {
  Pose pose;
  pose.linear *= scale;
  pose.origin = origin;
  return pose;
}

// The message of the Error that `call` throws, "" if it throws none.
template <class Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// A folder of this test's own, removed with what is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "picture-test-XXXXXX").string();
    if (!mkdtemp(name.data())) throw Error("no temporary folder");
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  int entries() const {
    return static_cast<int>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

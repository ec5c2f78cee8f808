// Prints how long a frame of 10,000 moving triangles takes, with floor, grid, sky, shadows and 4 samples a
// pixel:
//   build/bin/picture_frame_time [WIDTH HEIGHT]

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "shapes.h"
#include "softpoint/core/error.h"
#include "softpoint/picture/renderer.h"

namespace {

using namespace softpoint;
using namespace softpoint::picture;

double processor_ms() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto ms = [](const timeval& t) {
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
  };
  return ms(usage.ru_utime) + ms(usage.ru_stime);
}

void measure(int width, int height) {
  constexpr int kBalls = 5, kWarmUp = 5, kFrames = 60;
  RenderSettings settings;
  settings.width = width;
  settings.height = height;
  Renderer renderer(settings);
  const TriangleMesh ball = unit_sphere(40, 26);
  std::vector<int> meshes;
  for (int i = 0; i < kBalls; ++i) meshes.push_back(renderer.add_mesh(ball.vertices, ball.triangles));
  Camera camera;
  camera.eye = {3.2, 2.3, 5.2};
  camera.target = {0, 0.6, 0};
  std::vector<double> times;
  double processor = 0;
  Image image;
  for (int frame = 0; frame < kWarmUp + kFrames; ++frame) {
    if (frame == kWarmUp) processor = processor_ms();
    const auto start = std::chrono::steady_clock::now();
    renderer.begin(camera);
    renderer.draw_ground();
    for (int i = 0; i < kBalls; ++i) {
      const int mesh = meshes[static_cast<std::size_t>(i)];
      renderer.update_mesh(mesh, ball.vertices);
      Material material;
      material.color = palette_color(i);
      Pose pose;
      pose.linear *= 0.5;
      pose.origin = {-2 + 1.05 * i, 0.5, 0.2 * i - 0.5};
      renderer.draw_mesh(mesh, material, pose);
    }
    renderer.finish(image);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    if (frame >= kWarmUp) times.push_back(took.count());
  }
  processor = (processor_ms() - processor) / kFrames;
  std::sort(times.begin(), times.end());
  std::printf("%dx%d, %lld triangles: p10 %.1f ms, median %.1f ms a frame; processor time %.1f ms; %s\n",
              width, height, renderer.stats().triangles_drawn, times[kFrames / 10], times[kFrames / 2],
              processor, renderer.driver().c_str());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 3) {
      measure(std::atoi(argv[1]), std::atoi(argv[2]));
    } else {
      measure(640, 360);
      measure(1280, 720);
    }
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}

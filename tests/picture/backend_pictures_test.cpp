#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "scenes.h"
#include "shapes.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

constexpr double kSamePicture = 40;  // dB

RenderSettings with(RenderSettings settings, Backend backend) {
  settings.backend = backend;
  return settings;
}

Image render_alone(const PictureScene& scene, Backend backend) {
  Renderer renderer(with(scene.settings, backend));
  return render(scene, renderer);
}

class BackendPictures : public ::testing::TestWithParam<PictureScene> {};

// Bit by bit where the same rasteriser stands behind both, closely otherwise.
TEST_P(BackendPictures, EveryBackendDrawsTheSame) {
  const PictureScene& scene = GetParam();
  const std::vector<Backend> built = built_backends();
  if (built.size() < 2) GTEST_SKIP() << "this build has one backend only";
  Renderer reference_renderer(with(scene.settings, built[0]));
  const Image reference = render(scene, reference_renderer);
  for (std::size_t i = 1; i < built.size(); ++i) {
    Renderer renderer(with(scene.settings, built[i]));
    const Image image = render(scene, renderer);
    if (renderer.driver() == reference_renderer.driver()) {
      EXPECT_EQ(image, reference) << psnr(image, reference) << " dB";
    } else {
      EXPECT_GE(psnr(image, reference), kSamePicture) << renderer.driver();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, BackendPictures, ::testing::ValuesIn(picture_scenes()),
                         [](const auto& one) { return std::string(one.param.name); });

// Frames of renderers of all backends by turns, the order changing: each must draw what it draws alone,
// although the backends may share a slot for the current context.
TEST(BackendMix, RenderersOfAllBackendsByTurns) {
  const std::vector<PictureScene>& scenes = picture_scenes();
  struct Easel {
    const PictureScene* scene;
    std::unique_ptr<Renderer> renderer;
    Image alone;
  };
  std::vector<Easel> easels;
  for (int copy = 0; copy < 2; ++copy) {
    for (const Backend backend : built_backends()) {
      const PictureScene& scene = scenes[easels.size() % scenes.size()];
      easels.push_back({&scene, nullptr, render_alone(scene, backend)});
      easels.back().renderer = std::make_unique<Renderer>(with(scene.settings, backend));
    }
  }
  const std::size_t count = easels.size();
  for (std::size_t turn = 0; turn < 3 * count; ++turn) {
    const Easel& easel = easels[(turn * (1 + turn / count)) % count];
    EXPECT_EQ(render(*easel.scene, *easel.renderer), easel.alone) << easel.scene->name << " " << turn;
  }
  // One goes while the others stay.
  for (std::size_t gone = 0; gone + 1 < count; ++gone) {
    easels[gone].renderer.reset();
    const Easel& next = easels[count - 1 - gone % (count - 1 - gone)];
    EXPECT_EQ(render(*next.scene, *next.renderer), next.alone) << next.scene->name;
  }
}

TEST(BackendMix, ARendererPerThread) {
  const std::vector<PictureScene>& scenes = picture_scenes();
  for (const Backend backend : built_backends()) {
    std::vector<Image> images(4);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < images.size(); ++i) {
      threads.emplace_back([&, i] { images[i] = render_alone(scenes[i], backend); });
    }
    for (std::thread& thread : threads) thread.join();
    for (std::size_t i = 0; i < images.size(); ++i) {
      EXPECT_EQ(images[i], render_alone(scenes[i], backend)) << backend_name(backend);
    }
  }
}

// A renderer made in one thread, used in another.
TEST(BackendMix, ARendererMovesToAnotherThread) {
  const PictureScene& scene = picture_scenes().front();
  for (const Backend backend : built_backends()) {
    auto renderer = std::make_unique<Renderer>(with(scene.settings, backend));
    const Image here = render(scene, *renderer);
    Image there;
    std::thread([&] { there = render(scene, *renderer); }).join();
    EXPECT_EQ(there, here) << backend_name(backend);
    EXPECT_EQ(render(scene, *renderer), here) << backend_name(backend);
  }
}

int entries(const char* folder) {
  return static_cast<int>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

// A hundred contexts with all their buffers and programs, and four that drew something.
TEST(BackendMix, RenderersLeaveNothingBehind) {
  if (!std::filesystem::exists("/proc/self/task")) GTEST_SKIP() << "no /proc here";
  for (const Backend backend : built_backends()) {
    const auto come_and_go = [&](int empty, int full) {
      for (int i = 0; i < empty; ++i) Renderer(with(plain_settings(), backend));
      for (int i = 0; i < full; ++i) render_alone(picture_scenes().front(), backend);
    };
    come_and_go(5, 2);
    const int files = entries("/proc/self/fd"), threads = entries("/proc/self/task");
    const double before = resident_mb();
    come_and_go(100, 4);
    EXPECT_EQ(entries("/proc/self/fd"), files) << backend_name(backend);
    EXPECT_EQ(entries("/proc/self/task"), threads) << backend_name(backend);
    // One colour buffer with 4 samples is 0.3 MB of it, a shadow map 1 MB.
    EXPECT_LT(resident_mb() - before, 8) << backend_name(backend);
  }
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture

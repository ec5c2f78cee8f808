// What the steps of scenes cost: CPU time of this thread, without pictures, measurements and the building of
// the scene.
//   build/bin/scene_speed SCENE.json...
#include <cstdio>
#include <exception>

#include "benchmarks/thread_time.h"
#include "player.h"
#include "scene_reader.h"
#include "softpoint/elastic/character.h"

namespace softpoint::benchmarks {
namespace {

double part_of(std::vector<double> values, double part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void run(const char* name) {
  scene::Player player(scene::read_scene(name));
  const int frames = player.scene().frames;
  std::vector<double> seconds;
  double iterations = 0, evaluations = 0, balanced = 0, characters = 0, passes = 0, sweeps = 0;
  long long contacts = 0;
  for (int i = 0; i < frames; ++i) {
    const double start = thread_seconds();
    player.step();
    if (i > 0) seconds.push_back(thread_seconds() - start);  // the first step factors
    passes += static_cast<double>(player.work().passes);
    sweeps += static_cast<double>(player.work().iterations);
    contacts = std::max(contacts, player.work().contacts);
    for (std::size_t k = 0; k < player.deformable_count(); ++k) {
      const auto* const character = dynamic_cast<const elastic::Character*>(&player.deformable(k));
      if (character == nullptr) continue;
      const elastic::AssemblyReport& report = character->assembly().report();
      characters += 1;
      iterations += report.iterations;
      evaluations += report.evaluations;
      balanced += report.balanced ? 1 : 0;
    }
  }
  std::printf("%s: %d steps, ms: median %.3f, 90 of 100 below %.3f, most %.3f\n", name, frames,
              1e3 * median(seconds), 1e3 * part_of(seconds, 0.9), 1e3 * part_of(seconds, 1.0));
  std::printf("  contacts: at most %lld; a step: %.2f passes, %.1f sweeps\n", contacts, passes / frames,
              sweeps / frames);
  if (characters == 0) return;
  std::printf("  a character and step: %.2f iterations, %.2f evaluations; balanced in %.1f %%\n",
              iterations / characters, evaluations / characters, 100 * balanced / characters);
}

}  // namespace
}  // namespace softpoint::benchmarks

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: scene_speed SCENE.json...\n");
    return 2;
  }
  try {
    for (int i = 1; i < argc; ++i) softpoint::benchmarks::run(argv[i]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "scene_speed: %s\n", error.what());
    return 1;
  }
  return 0;
}

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "command.h"
#include "figure_motion_files.h"
#include "metrics_recorder.h"
#include "picture_output.h"
#include "player.h"
#include "scene_reader.h"
#include "sibling.h"
#include "softpoint/core/atomic_file.h"
#include "softpoint/core/error.h"
#include "trace_recorder.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

struct PlayOptions {
  std::string scene, out, size, metrics, trace, bvh, precision;
  int frames = 0;
  bool video = false, no_pictures = false;
};

// One line on stderr, renewed about twice a second once two seconds have passed.
class Progress {
 public:
  explicit Progress(int frames) : frames_(frames) {}
  ~Progress() {
    if (shown_) {
      fmt::print(stderr, "\n");
    }
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(int frame) {
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    if (seconds < next_) {
      return;
    }
    next_ = seconds + 0.5;
    shown_ = true;
    fmt::print(stderr, "\rframe {} of {}, {:.0f} s, about {:.0f} s to go  ", frame, frames_, seconds,
               seconds * (frames_ - frame) / std::max(frame, 1));
    std::fflush(stderr);
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  int frames_;
  double next_ = 2.0;
  bool shown_ = false;
};

// "1280x720"
std::optional<std::pair<int, int>> parse_size(const std::string& text) {
  int width = 0, height = 0, end = 0;
  const bool complete = std::sscanf(text.c_str(), "%dx%d%n", &width, &height, &end) == 2 &&
                        static_cast<std::size_t>(end) == text.size();
  if (!complete || std::min(width, height) < 16 || std::max(width, height) > 8192) {
    return std::nullopt;
  }
  return std::pair(width, height);
}

int play(const PlayOptions& options, const std::vector<std::string>& arguments) {
  if (!options.precision.empty()) {
    exec_sibling(options.precision == "double" ? Precision::kDouble : Precision::kSingle, arguments);
  }
  for (const std::string& file : {options.metrics, options.trace}) {
    if (!file.empty()) {
      check_writable(file);
    }
  }
  Scene scene = read_scene(options.scene);
  if (options.frames > 0) {
    scene.frames = options.frames;
  }
  if (const auto size = parse_size(options.size)) {
    std::tie(scene.pictures.width, scene.pictures.height) = *size;
  }
  Player player(std::move(scene));

  std::unique_ptr<PictureOutput> pictures;
  if (!options.no_pictures || options.video) {
    const auto folder = options.out.empty()
                            ? std::filesystem::path("out") / std::filesystem::path(options.scene).stem()
                            : std::filesystem::path(options.out);
    pictures =
        make_picture_output(player, {folder, player.scene().pictures.width, player.scene().pictures.height,
                                     !options.no_pictures, options.video});
    if (pictures) {
      pictures->take();
    } else {
      fmt::print(stderr, "no pictures, no film: this program was built without the picture plugin\n");
    }
  }
  std::optional<MetricsRecorder> metrics;
  if (!options.metrics.empty()) {
    metrics.emplace(player);
  }
  std::optional<TraceRecorder> trace;
  if (!options.trace.empty()) {
    trace.emplace(player);
  }
  std::optional<FigureMotionFiles> motion;
  if (!options.bvh.empty()) motion.emplace(player, options.bvh);

  double step_seconds = 0;
  {
    Progress progress(player.scene().frames);
    while (player.frame() < player.scene().frames) {
      player.step();
      step_seconds += player.work().step_seconds;
      if (metrics) {
        metrics->record();
      }
      if (trace) {
        trace->record();
      }
      if (motion) motion->record();
      if (pictures) {
        pictures->take();
      }
      progress.show(player.frame());
    }
  }

  fmt::print("{}: {} frames, {:.3f} s in {:.3f} s of steps, {:.3g} x real time\n", options.scene,
             player.frame(), player.time(), step_seconds, player.time() / step_seconds);
  if (metrics) {
    write_atomically(options.metrics, metrics->json());
    fmt::print("{}\n", options.metrics);
  }
  if (trace) {
    write_atomically(options.trace, trace->csv());
    fmt::print("{}\n", options.trace);
  }
  if (motion) {
    for (const std::string& file : motion->write()) fmt::print("{}\n", file);
  }
  if (pictures) {
    pictures->finish();
    fmt::print("{}: {} files\n", pictures->folder().string(), pictures->files().size());
  }
  return kExitDone;
}

}  // namespace

Command add_play_command(CLI::App& program, const std::vector<std::string>& arguments) {
  auto options = std::make_shared<PlayOptions>();
  CLI::App* app = program.add_subcommand("play", "Play a scene: pictures, film, measurements");
  app->add_option("SCENE", options->scene, "Scene file (JSON; see: softpoint schema play)")->required();
  app->add_option("--out", options->out, "Folder for pictures and film; out/<name of the scene>");
  app->add_option("--frames", options->frames, "Steps to play instead of the scene's")
      ->check(CLI::Range(1, 1000000));
  app->add_option("--size", options->size, "WIDTHxHEIGHT of pictures and film in pixels")
      ->check([](const std::string& text) {
        return parse_size(text) ? std::string() : "permitted is WIDTHxHEIGHT, each 16 to 8192: " + text;
      });
  app->add_flag("--video", options->video, "Write video.mp4 too (needs the program ffmpeg)");
  app->add_flag("--no-pictures", options->no_pictures, "Write no pictures");
  app->add_option("--metrics", options->metrics, "Write measurements (JSON)");
  app->add_option("--trace", options->trace, "Write a row a frame (CSV)");
  app->add_option("--bvh", options->bvh,
                  "Folder for the motion of each figure, for animation programs (BVH)");
  app->add_option("--precision", options->precision, "Of Bullet's numbers; this program's own if absent")
      ->check(CLI::IsMember({"single", "double"}));
  return {app, [options, arguments] { return play(*options, arguments); }};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene

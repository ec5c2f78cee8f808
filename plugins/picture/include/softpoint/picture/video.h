#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "softpoint/picture/image.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// How a video is encoded.
struct VideoSettings {
  double frames_per_second = 60;   // 1 to 1000
  int quality = 20;                // H.264 constant rate factor: 0 (lossless) to 51 (worst)
  std::string program = "ffmpeg";  // looked up in PATH unless it holds a slash
};

// Can `program` be started? No video otherwise; pictures always work.
SOFTPOINT_API bool video_available(const std::string& program = "ffmpeg");

// An MP4 (H.264, yuv420p) written by a separate ffmpeg process that is fed raw frames. Odd sizes are padded
// to even ones. Throws Error with the reason, and ffmpeg's own words, when the process cannot be started,
// stops early or fails; the calling process never gets a SIGPIPE from it.
class SOFTPOINT_API VideoWriter {
 public:
  // `path` is passed on as it is, without a shell: any file name will do. An existing file is replaced.
  VideoWriter(const std::string& path, int width, int height, const VideoSettings& settings = {});
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  // Ends the file as far as it got; close() tells whether that worked.
  ~VideoWriter();

  // The next frame, of the size given to the constructor.
  void add(const Image& frame);
  // Waits until the file is complete. No add() afterwards; calling it again does nothing.
  void close();
  // Frames added.
  int frame_count() const { return frame_count_; }

 private:
  void start(const VideoSettings& settings);
  int wait_for_exit();
  [[noreturn]] void fail(const std::string& what);

  std::string path_, program_;
  int width_, height_, frame_count_ = 0;
  int socket_ = -1;                   // our end of the process's standard input
  int process_ = -1;                  // its id, -1 once it has been waited for
  std::FILE* words_ = nullptr;        // what it writes to its standard error
  std::vector<std::uint8_t> packed_;  // one frame without opacity
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

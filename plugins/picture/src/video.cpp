#include "softpoint/picture/video.h"

#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "softpoint/core/error.h"

extern char** environ;

namespace softpoint::inline SOFTPOINT_ABI::picture {

bool video_available(const std::string& program) {
  if (program.find('/') != std::string::npos) return access(program.c_str(), X_OK) == 0;
  const char* path = std::getenv("PATH");
  std::string_view rest = path ? path : "";
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    const std::string candidate = std::string(rest.substr(0, colon)) + "/" + program;
    if (access(candidate.c_str(), X_OK) == 0) return true;
    rest.remove_prefix(colon == std::string_view::npos ? rest.size() : colon + 1);
  }
  return false;
}

VideoWriter::VideoWriter(const std::string& path, int width, int height, const VideoSettings& settings)
    : path_(path), program_(settings.program), width_(width), height_(height) {
  check_range("video width", width, 16, 8192);
  check_range("video height", height, 16, 8192);
  check_range("video frames_per_second", settings.frames_per_second, 1, 1000);
  check_range("video quality", settings.quality, 0, 51);
  if (path.empty()) throw Error("video path = \"\": permitted is a file name");
  packed_.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  start(settings);
}

void VideoWriter::start(const VideoSettings& settings) {
  if (!video_available(program_)) {
    throw Error(path_ + ": no video without the program \"" + program_ + "\", which is not installed");
  }
  // A socket instead of a pipe: writing to it can be told not to raise SIGPIPE.
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw Error(path_ + ": no socket for the video: " + std::strerror(errno));
  }
  words_ = std::tmpfile();
  if (!words_) {
    const std::string reason = std::strerror(errno);
    ::close(ends[0]);
    ::close(ends[1]);
    throw Error(path_ + ": no temporary file for the video: " + reason);
  }
  const std::string size = std::to_string(width_) + "x" + std::to_string(height_);
  const std::string rate = to_text(settings.frames_per_second);
  const std::string quality = std::to_string(settings.quality);
  const std::string target = "file:" + path_;  // so that no name is taken for an option or a protocol
  const std::array<const char*, 30> arguments = {program_.c_str(),
                                                 "-hide_banner",
                                                 "-loglevel",
                                                 "error",
                                                 "-y",
                                                 "-f",
                                                 "rawvideo",
                                                 "-pixel_format",
                                                 "rgb24",
                                                 "-video_size",
                                                 size.c_str(),
                                                 "-framerate",
                                                 rate.c_str(),
                                                 "-i",
                                                 "pipe:0",
                                                 "-an",
                                                 "-vf",
                                                 "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                                 "-c:v",
                                                 "libx264",
                                                 "-preset",
                                                 "veryfast",
                                                 "-crf",
                                                 quality.c_str(),
                                                 "-pix_fmt",
                                                 "yuv420p",
                                                 "-f",
                                                 "mp4",
                                                 target.c_str(),
                                                 nullptr};

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", 1 /* O_WRONLY */, 0);
  posix_spawn_file_actions_adddup2(&actions, fileno(words_), STDERR_FILENO);
  const int failed = posix_spawnp(&process_, program_.c_str(), &actions, nullptr,
                                  const_cast<char* const*>(arguments.data()), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  socket_ = ends[0];
  if (failed != 0) {
    process_ = -1;
    ::close(socket_);
    std::fclose(words_);
    throw Error(path_ + ": the program \"" + program_ + "\" cannot be started: " + std::strerror(failed));
  }
}

VideoWriter::~VideoWriter() {
  wait_for_exit();
  if (words_) std::fclose(words_);
}

int VideoWriter::wait_for_exit() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  if (process_ < 0) return 0;
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
  process_ = -1;
  return status;
}

void VideoWriter::fail(const std::string& what) {
  wait_for_exit();
  std::array<char, 500> text{};
  std::rewind(words_);
  const std::size_t length = std::fread(text.data(), 1, text.size() - 1, words_);
  std::string words(text.data(), length);
  while (!words.empty() && words.back() == '\n') words.pop_back();
  throw Error(path_ + ": " + program_ + " " + what + (words.empty() ? "" : ": " + words));
}

void VideoWriter::add(const Image& frame) {
  if (frame.width != width_ || frame.height != height_) {
    throw Error("video frame = " + std::to_string(frame.width) + "x" + std::to_string(frame.height) +
                ": permitted is " + std::to_string(width_) + "x" + std::to_string(height_));
  }
  if (socket_ < 0) throw Error(path_ + ": permitted is adding frames before close() and before a failure");
  for (std::size_t i = 0, o = 0; i < frame.rgba.size(); i += 4, o += 3) {
    packed_[o] = frame.rgba[i];
    packed_[o + 1] = frame.rgba[i + 1];
    packed_[o + 2] = frame.rgba[i + 2];
  }
  std::size_t sent = 0;
  while (sent < packed_.size()) {
    const ssize_t n = send(socket_, packed_.data() + sent, packed_.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("stopped after " + std::to_string(frame_count_) + " frames");
    sent += static_cast<std::size_t>(n);
  }
  ++frame_count_;
}

void VideoWriter::close() {
  if (process_ < 0) return;
  const int status = wait_for_exit();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail("failed");
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

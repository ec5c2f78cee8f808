#include "softpoint/picture/video.h"

#include <sys/stat.h>

#include <fstream>
#include <sstream>

#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

Image frame(int width, int height, int i) {
  return Image(width, height, {0.1F * static_cast<float>(i), 0.5F, 0.3F});
}

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// A stand-in for ffmpeg.
std::string script(const TemporaryFolder& folder, const std::string& body) {
  const std::string path = folder.file("stand-in");
  std::ofstream(path) << "#!/bin/sh\n" << body << "\n";
  chmod(path.c_str(), 0755);
  return path;
}

TEST(Video, IsAPlayableFileWhereFfmpegExists) {
  const TemporaryFolder folder;
  const std::string path = folder.file("-a 'quoted' \"name\" with $signs & blanks:.mp4");
  if (!video_available()) {
    EXPECT_TRUE(mentions(refusal([&] { VideoWriter(path, 64, 48); }), "not installed"));
    return;
  }
  VideoWriter video(path, 65, 47);  // odd: padded to even
  for (int i = 0; i < 10; ++i) video.add(frame(65, 47, i));
  video.close();
  EXPECT_EQ(video.frame_count(), 10);
  const std::string bytes = content(path);
  ASSERT_GT(bytes.size(), 500U);
  EXPECT_EQ(bytes.substr(4, 4), "ftyp");
  EXPECT_NE(bytes.find("moov"), std::string::npos) << "complete";
  EXPECT_NE(bytes.find("avc1"), std::string::npos) << "H.264";
  EXPECT_EQ(folder.entries(), 1);
}

TEST(Video, AbsenceOfTheProgramIsSaidAtOpen) {
  VideoSettings settings;
  settings.program = "no-such-video-program";
  EXPECT_FALSE(video_available(settings.program));
  const std::string message = refusal([&] { VideoWriter("a.mp4", 64, 48, settings); });
  EXPECT_TRUE(mentions(message, "no-such-video-program")) << message;
  EXPECT_TRUE(mentions(message, "not installed")) << message;
}

TEST(Video, FramesArriveAsRawRgb) {
  const TemporaryFolder folder;
  VideoSettings settings;
  settings.program = script(folder, "cat > \"" + folder.file("raw") + "\"");
  VideoWriter video(folder.file("a.mp4"), 16, 16, settings);
  Image image(16, 16);
  for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = static_cast<std::uint8_t>(i);
  video.add(image);
  video.add(image);
  video.close();
  const std::string raw = content(folder.file("raw"));
  ASSERT_EQ(raw.size(), 2U * 3 * 16 * 16);
  for (std::size_t i = 0; i < 256; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_EQ(static_cast<std::uint8_t>(raw[768 + 3 * i + c]), static_cast<std::uint8_t>(4 * i + c));
    }
  }
}

TEST(Video, AProgramThatDiesIsReportedWithItsWordsAndKillsNobody) {
  const TemporaryFolder folder;
  VideoSettings settings;
  settings.program = script(folder, "echo no such codec >&2; exit 3");
  VideoWriter video(folder.file("a.mp4"), 640, 480, settings);
  const std::string message = refusal([&] {
    for (int i = 0; i < 50; ++i) video.add(frame(640, 480, i));
  });
  EXPECT_TRUE(mentions(message, "stopped")) << message;
  EXPECT_TRUE(mentions(message, "no such codec")) << message;
  EXPECT_FALSE(refusal([&] { video.add(frame(640, 480, 0)); }).empty());
  video.close();
}

TEST(Video, AProgramThatFailsAtTheEndIsReportedByClose) {
  const TemporaryFolder folder;
  VideoSettings settings;
  settings.program = script(folder, "cat > /dev/null; echo disk is full >&2; exit 1");
  VideoWriter video(folder.file("a.mp4"), 64, 48, settings);
  video.add(frame(64, 48, 0));
  EXPECT_TRUE(mentions(refusal([&] { video.close(); }), "disk is full"));
  EXPECT_EQ(refusal([&] { video.close(); }), "") << "said once";
}

TEST(Video, RefusesByName) {
  VideoSettings settings;
  EXPECT_TRUE(mentions(refusal([&] { VideoWriter("a.mp4", 8, 48, settings); }), "video width = 8"));
  EXPECT_TRUE(mentions(refusal([&] { VideoWriter("", 64, 48, settings); }), "video path"));
  settings.frames_per_second = 0;
  EXPECT_TRUE(mentions(refusal([&] { VideoWriter("a.mp4", 64, 48, settings); }), "frames_per_second = 0"));
  settings = {};
  settings.quality = 52;
  EXPECT_TRUE(mentions(refusal([&] { VideoWriter("a.mp4", 64, 48, settings); }), "quality = 52"));
  const TemporaryFolder folder;
  settings = {};
  settings.program = script(folder, "cat > /dev/null");
  VideoWriter video(folder.file("a.mp4"), 64, 48, settings);
  EXPECT_TRUE(mentions(refusal([&] { video.add(frame(64, 50, 0)); }), "64x50"));
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture

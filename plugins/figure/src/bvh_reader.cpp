#include <charconv>
#include <cmath>
#include <fstream>
#include <istream>
#include <iterator>
#include <string_view>

#include "softpoint/core/error.h"
#include "softpoint/figure/bvh.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr int kMaxJoints = 10000, kMaxDepth = 256;
constexpr const char* kChannelNames[] = {"Xposition", "Yposition", "Zposition",
                                         "Xrotation", "Yrotation", "Zrotation"};

bool same_letters(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (lower(a[i]) != lower(b[i])) return false;
  }
  return true;
}

class BvhParser {
 public:
  BvhParser(std::string text, std::string name) : text_(std::move(text)), name_(std::move(name)) {}

  BvhClip parse() {
    expect("HIERARCHY");
    expect("ROOT");
    joint(-1, 1);
    if (same_letters(peek(), "ROOT")) refuse("a second ROOT", "one");
    expect("MOTION");
    expect("Frames:");
    const double frames = number("Frames", 0, 1e8);
    if (frames != std::floor(frames)) refuse("Frames: " + to_text(frames), "a whole number");
    expect("Frame");
    expect("Time:");
    clip_.frame_time = number("Frame Time", 1e-6, 1000);
    const auto count = static_cast<std::size_t>(frames) * static_cast<std::size_t>(clip_.channel_count());
    while (clip_.values.size() < count) clip_.values.push_back(number("channel", -1e9, 1e9));
    if (!peek().empty()) refuse("'" + shown(peek()) + "' after the last frame", "the end");
    return std::move(clip_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what, const std::string& permitted) const {
    throw Error(name_ + " line " + std::to_string(line_) + ": " + what + "; permitted is " + permitted);
  }
  static std::string shown(std::string_view word) { return std::string(word.substr(0, 40)); }

  std::string_view peek() {
    while (at_ < text_.size() && (text_[at_] == ' ' || (text_[at_] >= '\t' && text_[at_] <= '\r'))) {
      line_ += text_[at_] == '\n';
      ++at_;
    }
    std::size_t end = at_;
    while (end < text_.size() && text_[end] != ' ' && !(text_[end] >= '\t' && text_[end] <= '\r')) ++end;
    return std::string_view(text_).substr(at_, end - at_);
  }
  std::string_view word() {
    const std::string_view found = peek();
    at_ += found.size();
    return found;
  }
  void expect(std::string_view wanted) {
    const std::string_view found = word();
    if (!same_letters(found, wanted)) refuse("'" + shown(found) + "'", std::string(wanted));
  }
  double number(const char* what, double low, double high) {
    std::string_view digits = word();
    const std::string_view all = digits;
    if (!digits.empty() && digits[0] == '+') digits.remove_prefix(1);
    double value = 0;
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (code == std::errc::result_out_of_range && end == digits.data() + digits.size()) {
      value = digits.find("e-") != digits.npos || digits.find("E-") != digits.npos ? 0 : HUGE_VAL;
    } else if (digits.empty() || code != std::errc() || end != digits.data() + digits.size()) {
      refuse(std::string(what) + " '" + shown(all) + "'", "a number");
    }
    if (!(value >= low && value <= high)) {
      refuse(std::string(what) + " = " + shown(all), to_text(low) + " to " + to_text(high));
    }
    return value;
  }
  Vec3 offset() {
    expect("OFFSET");
    Vec3 value;
    for (int k = 0; k < 3; ++k) value[k] = number("OFFSET", -1e9, 1e9);
    return value;
  }
  void channels(BvhJoint& joint) {
    expect("CHANNELS");
    const double count = number("CHANNELS", 0, 6);
    if (count != std::floor(count)) refuse("CHANNELS " + to_text(count), "a whole number");
    for (int i = 0; i < static_cast<int>(count); ++i) {
      const std::string_view found = word();
      int channel = 0;
      while (channel < 6 && !same_letters(found, kChannelNames[channel])) ++channel;
      if (channel == 6) refuse("channel '" + shown(found) + "'", "Xposition to Zrotation");
      for (const BvhChannel other : joint.channels) {
        if (static_cast<int>(other) == channel) refuse("channel '" + shown(found) + "' twice", "once");
      }
      joint.channels.push_back(static_cast<BvhChannel>(channel));
    }
  }
  // Its name and what stands in braces after it.
  void joint(int parent, int depth) {
    if (depth > kMaxDepth) refuse("joints nested deeper than 256", "as deep");
    if (clip_.joints.size() >= static_cast<std::size_t>(kMaxJoints))
      refuse("more than 10000 joints", "as many");
    const int index = static_cast<int>(clip_.joints.size());
    BvhJoint joint_read;
    joint_read.parent = parent;
    while (peek() != "{" && !peek().empty()) {  // names may hold blanks
      if (!joint_read.name.empty()) joint_read.name += ' ';
      joint_read.name += word();
      if (joint_read.name.size() > 1000) refuse("a name of more than 1000 letters", "as long");
    }
    expect("{");
    joint_read.offset = offset();
    channels(joint_read);
    clip_.joints.push_back(std::move(joint_read));
    for (;;) {
      const std::string_view next = word();
      if (next == "}") return;
      if (same_letters(next, "JOINT")) {
        joint(index, depth + 1);
      } else if (same_letters(next, "End")) {
        expect("Site");
        expect("{");
        clip_.joints[static_cast<std::size_t>(index)].end_sites.push_back(offset());
        expect("}");
      } else {
        refuse("'" + shown(next) + "'", "JOINT, End Site or }");
      }
    }
  }

  std::string text_, name_;
  std::size_t at_ = 0;
  long long line_ = 1;
  BvhClip clip_;
};

}  // namespace

const char* name(BvhChannel channel) { return kChannelNames[static_cast<int>(channel)]; }

int BvhClip::channel_count() const {
  std::size_t count = 0;
  for (const BvhJoint& joint : joints) count += joint.channels.size();
  return static_cast<int>(count);
}

int BvhClip::frame_count() const {
  const int channels = channel_count();
  return channels == 0 ? 0 : static_cast<int>(values.size() / static_cast<std::size_t>(channels));
}

BvhClip read_bvh(std::istream& in, const std::string& name) {
  return BvhParser(std::string(std::istreambuf_iterator<char>(in), {}), name).parse();
}

BvhClip read_bvh_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path + " cannot be read");
  return read_bvh(file, path);
}

std::string bvh_text(const BvhClip& clip) {
  std::string text = "HIERARCHY\n";
  const auto put_offset = [&](const std::string& indent, const Vec3& offset) {
    text += indent + "OFFSET";
    for (int k = 0; k < 3; ++k) {
      text += ' ';
      text += to_text(offset[k]);
    }
    text += "\n";
  };
  // A stack of open joints: the next one belongs to the innermost that is its parent.
  std::vector<int> open;
  const auto close = [&] {
    const auto& joint = clip.joints[static_cast<std::size_t>(open.back())];
    const std::string indent(2 * open.size(), ' ');
    for (const Vec3& end : joint.end_sites) {
      text += indent + "End Site\n" + indent + "{\n";
      put_offset(indent + "  ", end);
      text += indent + "}\n";
    }
    open.pop_back();
    text += std::string(2 * open.size(), ' ') + "}\n";
  };
  for (int i = 0; i < static_cast<int>(clip.joints.size()); ++i) {
    const BvhJoint& joint = clip.joints[static_cast<std::size_t>(i)];
    while (!open.empty() && open.back() != joint.parent) close();
    if (open.empty() != (i == 0)) {
      throw Error("bvh joint " + std::to_string(i) + " '" + joint.name +
                  "' parent = " + std::to_string(joint.parent) +
                  "; permitted are joints each followed by all that hangs on it");
    }
    const std::string indent(2 * open.size(), ' ');
    text += indent + (open.empty() ? "ROOT " : "JOINT ") + joint.name + "\n" + indent + "{\n";
    put_offset(indent + "  ", joint.offset);
    text += indent + "  CHANNELS " + std::to_string(joint.channels.size());
    for (const BvhChannel channel : joint.channels) {
      text += ' ';
      text += name(channel);
    }
    text += "\n";
    open.push_back(i);
  }
  while (!open.empty()) close();
  text += "MOTION\nFrames: " + std::to_string(clip.frame_count()) +
          "\nFrame Time: " + to_text(clip.frame_time) + "\n";
  const auto row = static_cast<std::size_t>(clip.channel_count());
  for (std::size_t i = 0; i < clip.values.size(); ++i) {
    text += to_text(clip.values[i]);
    text += (i + 1) % row == 0 ? "\n" : " ";
  }
  return text;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure

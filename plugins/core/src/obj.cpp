#include "softpoint/core/obj.h"

// Numbers are double in the library that is linked.
#if !defined(TINYOBJLOADER_USE_DOUBLE)
#define TINYOBJLOADER_USE_DOUBLE
#endif
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <istream>
#include <limits>
#include <streambuf>
#include <string>
#include <string_view>
#include <system_error>

#include "softpoint/core/atomic_file.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

constexpr std::size_t kMaxLine = 1 << 20;

std::string_view next_token(std::string_view& text) {
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && blank(text.front())) {
    text.remove_prefix(1);
  }
  std::size_t length = 0;
  while (length < text.size() && !blank(text[length])) {
    ++length;
  }
  const std::string_view token = text.substr(0, length);
  text.remove_prefix(length);
  return token;
}

// Serves the loader one line at a time, so that while one of its callbacks runs, the line it comes
// from and its number are at hand. Comments go here too: the loader only knows those that fill a line.
// Only vertices and faces are passed on.
class LineSource : public std::streambuf {
 public:
  LineSource(std::istream& in, std::string file) : in_(in), file_(std::move(file)) {}

  std::string_view line() const { return line_; }

  [[noreturn]] void refuse(const std::string& problem) const {
    throw Error(file_ + ":" + std::to_string(number_) + ": " + problem);
  }

 protected:
  int_type underflow() override {
    if (!next_line()) {
      return traits_type::eof();
    }
    if (line_.find('\0') != std::string::npos) {
      refuse("a zero byte: this is no text file");
    }
    line_.erase(std::min(line_.find('#'), line_.size()));
    while (!line_.empty() && line_.back() == '\r') {
      line_.pop_back();
    }
    if (line_.find('\r') != std::string::npos) {
      refuse("a carriage return inside the line: end lines with a line feed");
    }
    if (!line_.empty() && line_.back() == '\\') {
      refuse("the line goes on in the next one: join the two lines");
    }
    std::string_view rest = line_;
    const std::string_view keyword = next_token(rest);
    if (keyword != "v" && keyword != "f") {
      line_.clear();  // materials, groups, ...: nothing the loader should act upon
    } else if (next_token(rest).empty()) {
      refuse(std::string(keyword) + " without numbers");
    }
    line_.push_back('\n');
    setg(line_.data(), line_.data(), line_.data() + line_.size());
    return traits_type::to_int_type(line_.front());
  }

 private:
  // Piece by piece: a device may hold a line without an end.
  bool next_line() {
    ++number_;
    line_.clear();
    for (bool whole = false; !whole;) {
      in_.getline(piece_.data(), static_cast<std::streamsize>(piece_.size()));
      const auto count = static_cast<std::size_t>(in_.gcount());
      if (count == 0) {
        return !line_.empty();
      }
      const bool full = in_.rdstate() == std::ios::failbit;  // the line goes on
      whole = !full;
      line_.append(piece_.data(),
                   full || in_.eof() ? count : count - 1);  // the line feed counts, but is not kept
      if (full) {
        in_.clear();
      }
      if (line_.size() > kMaxLine) {
        refuse("a line of more than " + std::to_string(kMaxLine) + " characters: permitted is up to " +
               std::to_string(kMaxLine));
      }
    }
    return true;
  }

  std::istream& in_;
  std::array<char, 4096> piece_;
  std::string file_;
  std::string line_;
  int number_ = 0;
};

struct Reading {
  LineSource& source;
  TriangleMesh& mesh;
};

// The loader takes "nan" and missing coordinates for 0 and rounds decimals a few units in the last
// place off, so the numbers are read once more from the line: strictly, exactly, whatever the locale.
void take_vertex(void* user, tinyobj::real_t, tinyobj::real_t, tinyobj::real_t, tinyobj::real_t) {
  auto& [source, mesh] = *static_cast<Reading*>(user);
  std::string_view rest = source.line();
  next_token(rest);  // "v"
  Vec3 x;
  for (int k = 0; k < 3; ++k) {
    const std::string_view token = next_token(rest);
    const std::string_view digits = token.starts_with('+') ? token.substr(1) : token;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x[k]);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(x[k])) {
      source.refuse("vertex " + std::to_string(mesh.vertex_count()) + " has the " + "xyz"[k] +
                    " coordinate \"" + std::string(token) + "\": permitted is a finite number");
    }
  }
  if (mesh.vertices.size() >= std::numeric_limits<int>::max()) {
    source.refuse("more vertices than an int can count");
  }
  mesh.vertices.push_back(x);
}

void take_face(void* user, tinyobj::index_t* corners, int count) {
  auto& [source, mesh] = *static_cast<Reading*>(user);
  const std::string face = "face " + std::to_string(mesh.triangle_count());
  if (count < 3) {
    source.refuse(face + " has " + std::to_string(count) + " corners: permitted is 3 or more");
  }
  std::string_view rest = source.line();
  next_token(rest);  // "f"
  std::vector<int> polygon(count);
  for (int k = 0; k < count; ++k) {
    const std::string_view token = next_token(rest);
    const std::string_view number = token.substr(0, token.find('/'));
    int given = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), given);
    const int vertices = mesh.vertex_count();
    if (error != std::errc() || end != number.data() + number.size() || given != corners[k].vertex_index ||
        given == 0 || given > vertices || given < -vertices) {
      source.refuse(face + " names vertex \"" + std::string(token) + "\": permitted is 1 to " +
                    std::to_string(vertices) + " or -" + std::to_string(vertices) +
                    " to -1, the vertices above this line");
    }
    polygon[k] = given > 0 ? given - 1 : vertices + given;
  }
  for (int k = 1; k + 1 < count; ++k) {
    mesh.triangles.push_back({polygon[0], polygon[k], polygon[k + 1]});
  }
}

}  // namespace

TriangleMesh read_obj(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw Error(file + ": is a folder; name an OBJ file");
  }
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    throw Error(file + ": cannot be read (" + (errno != 0 ? std::strerror(errno) : "open failed") +
                "); name an OBJ file that exists");
  }
  TriangleMesh mesh;
  LineSource source(in, file);
  Reading reading{source, mesh};
  tinyobj::callback_t callbacks;
  callbacks.vertex_cb = take_vertex;
  callbacks.index_cb = take_face;
  std::istream lines(&source);
  // Let errors thrown by the callbacks and by LineSource pass through the stream.
  lines.exceptions(std::ios::badbit);
  std::string warning, complaint;
  if (!tinyobj::LoadObjWithCallback(lines, callbacks, &reading, nullptr, &warning, &complaint)) {
    source.refuse(complaint.empty() ? "the OBJ loader gave up" : complaint);
  }
  if (in.bad()) {
    throw Error(file + ": reading failed half-way");
  }
  if (mesh.vertices.empty()) {
    throw Error(file + ": holds no vertices; an OBJ file needs lines \"v x y z\" and \"f i j k\"");
  }
  if (mesh.triangles.empty()) {
    throw Error(file + ": holds no faces; an OBJ file needs lines \"f i j k\"");
  }
  return mesh;
}

void write_obj(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string text;
  text.reserve(mesh.vertices.size() * 64 + mesh.triangles.size() * 24);
  for (const Vec3& x : mesh.vertices) {
    text += "v " + to_text(x.x()) + ' ' + to_text(x.y()) + ' ' + to_text(x.z()) + '\n';
  }
  for (const Triangle& t : mesh.triangles) {
    text += "f " + std::to_string(t[0] + 1) + ' ' + std::to_string(t[1] + 1) + ' ' +
            std::to_string(t[2] + 1) + '\n';
  }
  write_atomically(path, text);
}

}  // namespace softpoint::inline SOFTPOINT_ABI

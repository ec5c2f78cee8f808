#include "softpoint/picture/png.h"

#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// libpng's errors leave by longjmp: between setjmp and here no object with a destructor may come alive.
struct Message {
  char text[200] = "unknown error";
};

void keep_error(png_structp png, png_const_charp text) {
  std::snprintf(static_cast<Message*>(png_get_error_ptr(png))->text, sizeof Message::text, "%s", text);
  png_longjmp(png, 1);
}

void drop_warning(png_structp, png_const_charp) {}

bool encode(std::FILE* file, const Image& image, int compression, png_bytep row, Message& message) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &message, &keep_error, &drop_warning);
  if (!png) return false;
  png_infop info = png_create_info_struct(png);
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_init_io(png, file);
  png_set_compression_level(png, compression);
  // One filter for all rows: choosing among them costs more time than it saves bytes at these levels.
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* source = image.pixel(0, y);
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) row[3 * x + c] = source[4 * x + c];
    }
    png_write_row(png, row);
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

void write_png(const std::string& path, const Image& image, int compression) {
  check_range("png compression", compression, 1, 3);
  if (image.width < 1 || image.height < 1)
    throw Error(path + ": permitted is a picture of at least one pixel");
  const File file(std::fopen(path.c_str(), "wb"));
  if (!file) throw Error(path + ": cannot be written: " + std::strerror(errno));
  std::vector<png_byte> row(3 * static_cast<std::size_t>(image.width));
  Message message;
  if (encode(file.get(), image, compression, row.data(), message) && std::fflush(file.get()) == 0) return;
  const std::string reason = errno != 0 ? std::strerror(errno) : message.text;
  std::remove(path.c_str());
  throw Error(path + ": cannot be written: " + reason);
}

Image read_png(const std::string& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&header, path.c_str())) {
    throw Error(path + ": cannot be read: " + header.message);
  }
  header.format = PNG_FORMAT_RGBA;
  if (header.width > 65536 || header.height > 65536) {
    png_image_free(&header);
    throw Error(path + ": picture size " + std::to_string(header.width) + "x" +
                std::to_string(header.height) + ": permitted is up to 65536 a side");
  }
  Image image(static_cast<int>(header.width), static_cast<int>(header.height));
  if (!png_image_finish_read(&header, nullptr, image.rgba.data(), 0, nullptr)) {
    throw Error(path + ": cannot be read: " + header.message);
  }
  return image;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

// SPDX-License-Identifier: Apache-2.0
// PNG encoding with libpng. It reports errors by longjmp, so the function that calls setjmp has no
// local variables with destructors.
#include <bit>
#include <csetjmp>
#include <vector>

#include <png.h>
#include <zlib.h>

#include "hal/base/partial_path.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::image_io {
namespace {

/// Filtered camera pictures have noise and few repeated strings, so only runs are compressed
/// (Z_RLE): that is faster than a search for strings, and the files are no larger.
constexpr int kStrategy = Z_RLE;

struct PngRows {
  Size size;
  int bit_depth;
  int color_type;
  std::vector<png_const_bytep> rows;
};

void on_error(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void on_warning(png_structp, png_const_charp) {}
void on_write(png_structp png, png_bytep bytes, std::size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))
      ->append(reinterpret_cast<const char*>(bytes), count);
}
void on_flush(png_structp) {}

bool encode(png_structp png, png_infop info, const PngRows& picture, std::string& out) {
  if (png == nullptr || info == nullptr || setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_write_fn(png, &out, on_write, on_flush);
  png_set_compression_strategy(png, kStrategy);
  png_set_IHDR(png, info, static_cast<png_uint_32>(picture.size.width),
               static_cast<png_uint_32>(picture.size.height), picture.bit_depth, picture.color_type,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  if (picture.bit_depth == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  for (png_const_bytep row : picture.rows) png_write_row(png, row);
  png_write_end(png, info);
  return true;
}

template <typename T>
Result<std::string> encode(ImageView<const T> image, int bit_depth, int color_type) {
  if (image.empty()) return Error{ErrorCode::kIo, "it has no pixels"};
  PngRows picture{image.size, bit_depth, color_type, {}};
  for (int y = 0; y < image.size.height; ++y)
    picture.rows.push_back(reinterpret_cast<png_const_bytep>(image.row(y)));
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  const bool done = encode(png, info, picture, bytes);
  png_destroy_write_struct(&png, &info);
  if (!done) return Error{ErrorCode::kIo, "libpng cannot encode it"};
  return bytes;
}

template <typename T>
Result<void> write(const std::filesystem::path& path, ImageView<const T> image, int bit_depth,
                   int color_type) {
  const auto bytes = encode(image, bit_depth, color_type);
  if (!bytes)
    return Error{bytes.error().code,
                 "cannot write picture '" + path.string() + "': " + bytes.error().context};
  return write_file(path, *bytes);
}

}  // namespace

Result<std::string> encode_png(ImageView<const Rgb8> image) {
  return encode(image, 8, PNG_COLOR_TYPE_RGB);
}

Result<void> write_png(const std::filesystem::path& path, ImageView<const Rgb8> image) {
  return write(path, image, 8, PNG_COLOR_TYPE_RGB);
}

Result<void> write_png(const std::filesystem::path& path, ImageView<const std::uint8_t> image) {
  return write(path, image, 8, PNG_COLOR_TYPE_GRAY);
}

Result<void> write_png(const std::filesystem::path& path, ImageView<const std::uint16_t> image) {
  return write(path, image, 16, PNG_COLOR_TYPE_GRAY);
}

}  // namespace mixrig::image_io

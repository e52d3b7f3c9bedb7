// SPDX-License-Identifier: Apache-2.0
// PNG encoding with libpng. libpng leaves by longjmp, so the function that calls setjmp holds
// nothing that needs a destructor.
#include <bit>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <vector>

#include <png.h>

#include "host/image_io/image_io.h"
#include "host/image_io/partial_path.h"

namespace mixrig::image_io {
namespace {

/// zlib level: takes are written frame by frame, and level 9 saves a few per cent for many
/// times the time.
constexpr int kCompression = 3;

struct PngRows {
  Size size;
  int bit_depth;
  int color_type;
  std::vector<png_const_bytep> rows;
};

void on_error(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void on_warning(png_structp, png_const_charp) {}

bool encode(png_structp png, png_infop info, std::FILE* file, const PngRows& picture) {
  if (png == nullptr || info == nullptr || setjmp(png_jmpbuf(png)) != 0) return false;
  png_init_io(png, file);
  png_set_compression_level(png, kCompression);
  png_set_IHDR(png, info, static_cast<png_uint_32>(picture.size.width),
               static_cast<png_uint_32>(picture.size.height), picture.bit_depth, picture.color_type,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  if (picture.bit_depth == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  for (png_const_bytep row : picture.rows) png_write_row(png, row);
  png_write_end(png, info);
  return true;
}

bool encode(std::FILE* file, const PngRows& picture) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  const bool done = encode(png, info, file, picture);
  png_destroy_write_struct(&png, &info);
  return done;
}

template <typename T>
Result<void> write(const std::filesystem::path& path, ImageView<const T> image, int bit_depth,
                   int color_type) {
  const std::string what = "cannot write picture '" + path.string() + "'";
  if (image.empty()) return Error{ErrorCode::kIo, what + ": it has no pixels"};
  PngRows picture{image.size, bit_depth, color_type, {}};
  for (int y = 0; y < image.size.height; ++y)
    picture.rows.push_back(reinterpret_cast<png_const_bytep>(image.row(y)));

  PartialPath partial(path);
  std::FILE* file = std::fopen(partial.path().c_str(), "wb");
  if (file == nullptr) return system_error(ErrorCode::kIo, what, errno);
  const bool encoded = encode(file, picture);
  const int encode_errno = errno;
  const bool closed = std::fclose(file) == 0;
  if (!encoded || !closed)
    return system_error(ErrorCode::kIo, what, encoded ? errno : encode_errno);
  return partial.commit();
}

}  // namespace

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

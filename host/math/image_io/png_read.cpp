// SPDX-License-Identifier: Apache-2.0
// PNG decoding with libpng. It reports errors by longjmp, so functions that call setjmp have no
// local variables with destructors.
#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <vector>

#include <png.h>

#include "host/math/image_io/codecs.h"

namespace mixrig::image_io {
namespace {

/// Highest compression ratio of deflate (zlib, "Technical Details"); a header that declares more
/// data is damaged, and is refused before memory is allocated.
constexpr std::size_t kMaxInflation = 1032;

class PngReader {
 public:
  explicit PngReader(Bytes bytes) : rest_(bytes), size_(bytes.size()) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  bool read_header() {
    if (png_ == nullptr || info_ == nullptr) return false;
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_user_limits(png_, kMaxSidePx, kMaxSidePx);
    png_set_read_fn(png_, this, on_read);
    png_read_info(png_, info_);
    raw_bytes_ = png_get_rowbytes(png_, info_) * png_get_image_height(png_, info_);
    return true;
  }

  /// Converts any colour type to 8-bit RGB; transparency is dropped.
  bool convert_to_rgb8() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_expand(png_);
    png_set_scale_16(png_);
    png_set_strip_alpha(png_);
    png_set_gray_to_rgb(png_);
    return true;
  }

  /// Converts 16-bit values to this machine's byte order (big-endian in the file).
  bool convert_to_native16() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    if constexpr (std::endian::native == std::endian::little) png_set_swap(png_);
    return true;
  }

  /// Applies the conversions; false if the file is too short for the declared size.
  bool start() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    if (raw_bytes_ / kMaxInflation <= size_) return true;
    why_ = "the file ends too early";
    return false;
  }

  bool read_rows(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  Size size() const {
    return {static_cast<int>(png_get_image_width(png_, info_)),
            static_cast<int>(png_get_image_height(png_, info_))};
  }
  int bit_depth() const { return png_get_bit_depth(png_, info_); }
  bool is_gray() const { return png_get_color_type(png_, info_) == PNG_COLOR_TYPE_GRAY; }
  std::string why() const { return why_; }

 private:
  static void on_error(png_structp png, png_const_charp text) {
    auto* self = static_cast<PngReader*>(png_get_error_ptr(png));
    std::strncpy(self->text_, text, sizeof(self->text_) - 1);
    self->why_ = self->text_;
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
  static void on_read(png_structp png, png_bytep out, std::size_t count) {
    auto* self = static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > self->rest_.size()) png_error(png, "the file ends too early");
    std::memcpy(out, self->rest_.data(), count);
    self->rest_ = self->rest_.subspan(count);
  }

  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  Bytes rest_;
  std::size_t size_;
  std::size_t raw_bytes_ = 0;  ///< uncompressed size of the deflate stream
  char text_[128] = {};
  const char* why_ = "out of memory";
};

template <typename T>
Result<void> read_pixels(PngReader& reader, const std::string& name, Image<T>& image) {
  if (!reader.start()) return bad_picture(name, reader.why());
  resize(image, reader.size());
  std::vector<png_bytep> rows(static_cast<std::size_t>(image.height()));
  for (int y = 0; y < image.height(); ++y)
    rows[static_cast<std::size_t>(y)] = reinterpret_cast<png_bytep>(image.row(y));
  if (!reader.read_rows(rows.data())) return bad_picture(name, reader.why());
  return {};
}

}  // namespace

bool is_png(Bytes bytes) { return bytes.size() >= 8 && png_sig_cmp(bytes.data(), 0, 8) == 0; }

Result<Size> png_size(Bytes bytes, const std::string& name) {
  PngReader reader(bytes);
  if (!reader.read_header()) return bad_picture(name, reader.why());
  return reader.size();
}

Result<void> decode_png(Bytes bytes, const std::string& name, Image<Rgb8>& image) {
  PngReader reader(bytes);
  if (!reader.read_header() || !reader.convert_to_rgb8()) return bad_picture(name, reader.why());
  return read_pixels(reader, name, image);
}

Result<void> decode_png(Bytes bytes, const std::string& name, Image<std::uint16_t>& image) {
  PngReader reader(bytes);
  if (!reader.read_header()) return bad_picture(name, reader.why());
  if (!reader.is_gray() || reader.bit_depth() < 8)
    return bad_picture(name, "not a grey PNG of 16 bit", "store it as one");
  if (reader.bit_depth() == 16) {
    if (!reader.convert_to_native16()) return bad_picture(name, reader.why());
    return read_pixels(reader, name, image);
  }
  Image<std::uint8_t> bytes_image;
  MIXRIG_TRY(read_pixels(reader, name, bytes_image));
  resize(image, bytes_image.size());
  for (int y = 0; y < image.height(); ++y)
    std::copy_n(bytes_image.row(y), image.width(), image.row(y));
  return {};
}

Result<void> decode_png(Bytes bytes, const std::string& name, Image<std::uint8_t>& image) {
  PngReader reader(bytes);
  if (!reader.read_header()) return bad_picture(name, reader.why());
  if (!reader.is_gray() || reader.bit_depth() != 8)
    return bad_picture(name, "not a grey PNG of 8 bit", "store it as one");
  return read_pixels(reader, name, image);
}

}  // namespace mixrig::image_io

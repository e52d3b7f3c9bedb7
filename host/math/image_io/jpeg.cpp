// SPDX-License-Identifier: Apache-2.0
// JPEG decoding with libjpeg. It reports errors by longjmp, so functions that call setjmp have no
// local variables with destructors.
#include <csetjmp>
#include <cstddef>
#include <cstdio>

#include <jerror.h>
#include <jpeglib.h>

#include "host/math/image_io/codecs.h"

namespace mixrig::image_io {
namespace {

/// Each block of 8x8 pixels takes at least one bit in the file; a header that declares more pixels
/// is damaged, and is refused before memory is allocated.
constexpr std::size_t kMaxPixelsPerByte = 8 * 64;

class JpegReader {
 public:
  explicit JpegReader(Bytes bytes) : size_(bytes.size()) {
    info_.err = jpeg_std_error(&errors_);
    info_.client_data = this;
    errors_.error_exit = on_error;
    errors_.emit_message = on_message;
    created_ = create(bytes);
  }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
  ~JpegReader() {
    if (created_) jpeg_destroy_decompress(&info_);
  }

  bool read_header() {
    if (!created_ || setjmp(jump_) != 0) return false;
    jpeg_read_header(&info_, TRUE);
    info_.out_color_space = JCS_RGB;
    if (info_.image_width > kMaxSidePx || info_.image_height > kMaxSidePx)
      return refuse("larger than 16384 pixels a side");
    if (size().area() / kMaxPixelsPerByte > size_) return refuse("the file ends too early");
    return true;
  }

  /// Rows are packed RGB of size().width pixels.
  bool read_rows(ImageView<Rgb8> image) {
    if (setjmp(jump_) != 0) return false;
    jpeg_start_decompress(&info_);
    while (info_.output_scanline < info_.output_height) {
      auto* row = reinterpret_cast<JSAMPROW>(image.row(static_cast<int>(info_.output_scanline)));
      jpeg_read_scanlines(&info_, &row, 1);
    }
    jpeg_finish_decompress(&info_);
    return true;
  }

  Size size() const {
    return {static_cast<int>(info_.image_width), static_cast<int>(info_.image_height)};
  }
  std::string why() const { return why_; }

 private:
  bool create(Bytes bytes) {
    if (setjmp(jump_) != 0) return false;
    jpeg_create_decompress(&info_);
    jpeg_mem_src(&info_, bytes.data(), bytes.size());
    return true;
  }
  bool refuse(const char* why) {
    std::snprintf(why_, sizeof(why_), "%s", why);
    return false;
  }

  static void on_error(j_common_ptr info) {
    auto* self = static_cast<JpegReader*>(info->client_data);
    info->err->format_message(info, self->why_);
    std::longjmp(self->jump_, 1);
  }
  /// libjpeg fills in missing data and only warns; here that is an error.
  static void on_message(j_common_ptr info, int level) {
    if (level < 0 && info->err->msg_code != JWRN_EXTRANEOUS_DATA) on_error(info);
  }

  jpeg_decompress_struct info_{};
  jpeg_error_mgr errors_{};
  std::jmp_buf jump_{};
  std::size_t size_;
  bool created_ = false;
  char why_[JMSG_LENGTH_MAX] = "out of memory";
};

}  // namespace

bool is_jpeg(Bytes bytes) {
  return bytes.size() >= 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

Result<Size> jpeg_size(Bytes bytes, const std::string& name) {
  JpegReader reader(bytes);
  if (!reader.read_header()) return bad_picture(name, reader.why());
  return reader.size();
}

Result<void> decode_jpeg(Bytes bytes, const std::string& name, Image<Rgb8>& image) {
  JpegReader reader(bytes);
  if (!reader.read_header()) return bad_picture(name, reader.why());
  resize(image, reader.size());
  if (!reader.read_rows(image)) return bad_picture(name, reader.why());
  return {};
}

}  // namespace mixrig::image_io

// SPDX-License-Identifier: Apache-2.0
// JPEG encoding with libjpeg. It reports errors by longjmp, so functions that call setjmp have no
// local variables with destructors.
#include "host/math/image_io/jpeg_write.h"

#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

#include "host/math/image_io/codecs.h"

namespace mixrig::image_io {
namespace {

class JpegWriter {
 public:
  JpegWriter() {
    info_.err = jpeg_std_error(&errors_);
    info_.client_data = this;
    errors_.error_exit = on_write_error;
  }
  JpegWriter(const JpegWriter&) = delete;
  JpegWriter& operator=(const JpegWriter&) = delete;
  ~JpegWriter() {
    jpeg_destroy_compress(&info_);
    std::free(bytes_);
  }

  bool write(ImageView<const Rgb8> image, int quality) {
    if (setjmp(jump_) != 0) return false;
    jpeg_create_compress(&info_);
    jpeg_mem_dest(&info_, &bytes_, &size_);
    info_.image_width = static_cast<JDIMENSION>(image.size.width);
    info_.image_height = static_cast<JDIMENSION>(image.size.height);
    info_.input_components = 3;
    info_.in_color_space = JCS_RGB;
    jpeg_set_defaults(&info_);
    jpeg_set_quality(&info_, quality, TRUE);
    info_.dct_method = JDCT_FASTEST;
    jpeg_start_compress(&info_, TRUE);
    while (info_.next_scanline < info_.image_height) {
      // libjpeg does not write to it.
      auto* row = const_cast<JSAMPROW>(
          reinterpret_cast<const JSAMPLE*>(image.row(static_cast<int>(info_.next_scanline))));
      jpeg_write_scanlines(&info_, &row, 1);
    }
    jpeg_finish_compress(&info_);
    return true;
  }
  std::string text() const { return {reinterpret_cast<const char*>(bytes_), size_}; }
  std::string why() const { return why_; }

 private:
  static void on_write_error(j_common_ptr info) {
    auto* self = static_cast<JpegWriter*>(info->client_data);
    info->err->format_message(info, self->why_);
    std::longjmp(self->jump_, 1);
  }

  jpeg_compress_struct info_{};
  jpeg_error_mgr errors_{};
  std::jmp_buf jump_{};
  unsigned char* bytes_ = nullptr;
  unsigned long size_ = 0;
  char why_[JMSG_LENGTH_MAX] = "out of memory";
};

}  // namespace

Result<std::string> encode_jpeg(ImageView<const Rgb8> image, int quality) {
  if (image.size.empty() || image.size.width > kMaxSidePx || image.size.height > kMaxSidePx)
    return Error{ErrorCode::kIo,
                 "cannot encode a picture: it has no pixels, or more than 16384 a side"};
  JpegWriter writer;
  if (!writer.write(image, quality))
    return Error{ErrorCode::kIo, "cannot encode a picture: " + writer.why()};
  return writer.text();
}

}  // namespace mixrig::image_io

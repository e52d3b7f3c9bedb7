// SPDX-License-Identifier: Apache-2.0
// The decoders behind image_io.h, on bytes in memory. Private to this module.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::image_io {

using Bytes = std::span<const std::uint8_t>;

constexpr int kMaxSidePx = 16384;

bool is_png(Bytes bytes);
bool is_jpeg(Bytes bytes);

/// Each fills `image`; `name` appears in the error line. Errors: kFormat.
Result<void> decode_png(Bytes bytes, const std::string& name, Image<Rgb8>& image);
Result<void> decode_png(Bytes bytes, const std::string& name, Image<std::uint16_t>& image);
Result<void> decode_png(Bytes bytes, const std::string& name, Image<std::uint8_t>& image);
Result<void> decode_jpeg(Bytes bytes, const std::string& name, Image<Rgb8>& image);

/// The size by the header. Errors: kFormat.
Result<Size> png_size(Bytes bytes, const std::string& name);
Result<Size> jpeg_size(Bytes bytes, const std::string& name);

/// "cannot read picture NAME: WHY: WHAT TO DO".
Error bad_picture(const std::string& name, const std::string& why,
                  const std::string& what_to_do = "replace the file");

/// Gives the image a size; does nothing if it has that size already.
template <typename T>
void resize(Image<T>& image, Size size) {
  if (image.size() != size) image.reset(size);
}

}  // namespace mixrig::image_io

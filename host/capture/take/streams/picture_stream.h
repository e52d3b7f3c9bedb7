// SPDX-License-Identifier: Apache-2.0
// A stream of pictures of a take, in any storage format. Private to this module.
#pragma once

#include <cstdint>
#include <string>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::take {

/// Pixel format of a stream: 8-bit colour, or 16-bit grey.
enum class PixelKind { kRgb8, kGray16 };

/// Random access by index (0-based); reading forwards is fast for every kind. Not thread-safe.
class PictureStream {
 public:
  virtual ~PictureStream() = default;
  /// Name of picture `index` for error messages.
  virtual std::string name(int index) const = 0;
  /// Reads picture `index`. Errors: kNotFound, kFormat, kData, naming the file.
  virtual Result<void> read(int index, Image<Rgb8>& image) = 0;
  virtual Result<void> read(int index, Image<std::uint16_t>& image) = 0;
  /// True if the stream holds metres, not steps: then only this read() may be called.
  virtual bool holds_float() const { return false; }
  virtual Result<void> read(int index, Image<float>& image) = 0;
};

}  // namespace mixrig::take

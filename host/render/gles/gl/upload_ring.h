// SPDX-License-Identifier: Apache-2.0
// Uploads a picture a frame without waiting for the GPU.
#pragma once

#include <array>

#include "host/render/contract/compositor.h"
#include "host/render/gles/gl/gl_texture.h"

namespace mixrig::render::gles {

/// Buffers from which the driver takes pictures while the next one is written: one more than there
/// are frames in flight.
class UploadRing {
 public:
  /// Copies a picture, of any stride, into a texture of its size. Drivers repack three bytes a
  /// texel slowly, so that four are written. Allocates in the first round. Errors: kDevice.
  Result<void> upload(const Texture& texture, ImageView<const Rgb8> picture);  // GL_SRGB8_ALPHA8

 private:
  std::array<BufferHandle, Compositor::kMostInFlight + 1> buffers_;
  std::size_t next_ = 0;
  Size size_{};
};

}  // namespace mixrig::render::gles

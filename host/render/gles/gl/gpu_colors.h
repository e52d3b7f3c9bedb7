// SPDX-License-Identifier: Apache-2.0
// Composites kept in GPU memory, for a screen whose context is shared with the compositor.
#pragma once

#include <memory>
#include <vector>

#include "host/render/gles/gl/gl_texture.h"

namespace mixrig::render::gles {

class GpuColor;

/// A pool of textures, as many as composites are in use at a time. All calls and the destructor
/// must run in the compositor's thread with its context current; pictures that outlive the pool are
/// empty.
class GpuColors {
 public:
  /// Whether the driver has glCopyImageSubData (OpenGL ES 3.2, GL_EXT_copy_image).
  static bool are_possible();
  /// Precondition: are_possible().
  explicit GpuColors(Size size_px) : size_px_(size_px) {}
  GpuColors(const GpuColors&) = delete;
  GpuColors& operator=(const GpuColors&) = delete;
  ~GpuColors();

  /// Queues a copy of a texture of four bytes a pixel. Allocates only if more pictures are in use
  /// than ever before.
  std::shared_ptr<const GpuPicture> copy(const Texture& color);

 private:
  const Size size_px_;
  std::vector<std::shared_ptr<GpuColor>> pictures_;
};

}  // namespace mixrig::render::gles

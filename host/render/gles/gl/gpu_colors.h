// SPDX-License-Identifier: Apache-2.0
// Composites that stay in the GPU's memory, for a screen that shares the compositor's objects.
#pragma once

#include <memory>
#include <vector>

#include "host/render/gles/gl/gl_texture.h"

namespace mixrig::render::gles {

class GpuColor;

/// As many textures as composites are in use at one time. For the compositor's thread, and its
/// context is current in all calls and at the end; pictures that outlive it are empty.
class GpuColors {
 public:
  /// Whether the driver has glCopyImageSubData (OpenGL ES 3.2, GL_EXT_copy_image).
  static bool are_possible();
  /// Precondition: are_possible().
  explicit GpuColors(Size size_px) : size_px_(size_px) {}
  GpuColors(const GpuColors&) = delete;
  GpuColors& operator=(const GpuColors&) = delete;
  ~GpuColors();

  /// Queues a copy of a texture of four bytes a pixel. Allocates only where more pictures are in
  /// use than ever before.
  std::shared_ptr<const GpuPicture> copy(const Texture& color);

 private:
  const Size size_px_;
  std::vector<std::shared_ptr<GpuColor>> pictures_;
};

}  // namespace mixrig::render::gles

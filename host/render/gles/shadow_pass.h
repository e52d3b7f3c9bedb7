// SPDX-License-Identifier: Apache-2.0
// Pass shadow: one depth map a lamp.
#pragma once

#include <vector>

#include "host/render/gles/gl_mesh.h"
#include "host/render/gles/gl_program.h"

namespace mixrig::render::gles {

class ShadowPass {
 public:
  static Result<ShadowPass> create();
  /// Draws the maps of all lamps that have one; `meshes` as params.draws. Allocates only when the
  /// size of the maps changes. Errors: kUnsupported where there is no memory for them.
  Result<void> draw(const FrameParams& params, const std::vector<GpuMesh>& meshes);

  /// GL_TEXTURE_2D_ARRAY of window depths (gl_convention.h: near / z, 0 for nothing), a layer a
  /// lamp; 0 before the first draw.
  GLuint maps() const { return maps_.get(); }
  const std::vector<FramebufferHandle>& targets() const { return targets_; }

 private:
  Result<void> allocate(int size_texel, std::size_t lamps);

  int size_texel_ = 0;
  TextureHandle maps_;
  std::vector<FramebufferHandle> targets_;
  Program program_;
  GLint clip_from_object_ = -1;
};

}  // namespace mixrig::render::gles

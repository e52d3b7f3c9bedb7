// SPDX-License-Identifier: Apache-2.0
// Pass shadow: draws one depth map a lamp.
#pragma once

#include <vector>

#include "host/render/gles/gl/gl_mesh.h"
#include "host/render/gles/gl/map_array.h"

namespace mixrig::render::gles {

class ShadowPass {
 public:
  static Result<ShadowPass> create();
  /// Draws the maps of all lamps that have one; `meshes` in the order of params.draws. Allocates
  /// only if the size of the maps changes. Errors: kUnsupported without memory for them.
  Result<void> draw(const FrameParams& params, const std::vector<GpuMesh>& meshes);

  GLuint maps() const { return maps_.name(); }  ///< MapArray; 0 before the first draw
  const std::vector<FramebufferHandle>& targets() const { return maps_.targets(); }

 private:
  MapArray maps_;
  Program program_;
  GLint clip_from_object_ = -1;
};

}  // namespace mixrig::render::gles

// SPDX-License-Identifier: Apache-2.0
// The shadow maps of all lamps.
#pragma once

#include <vector>

#include "host/render/gles/gl/gl_program.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::gles {

/// GL_TEXTURE_2D_ARRAY of window depths (gl_convention.h: near / z, 0 for nothing), a layer a lamp.
class MapArray {
 public:
  /// Makes the maps as large as the largest of `lamps`; does nothing where they are. Errors:
  /// kUnsupported where there is no memory for them.
  Result<void> allocate(const std::vector<LampParams>& lamps);
  /// Clears the map of a lamp and draws into it from now on, the nearest surface first.
  void begin(std::size_t lamp) const;

  GLuint name() const { return maps_.get(); }  ///< 0 before the first allocate()
  int size_texel() const { return size_texel_; }
  const std::vector<FramebufferHandle>& targets() const { return targets_; }

 private:
  int size_texel_ = 0;
  TextureHandle maps_;
  std::vector<FramebufferHandle> targets_;
};

/// Takes lamp axes to clip space of the lamp's map.
glm::mat4 clip_from_lamp(const LampParams& lamp);

}  // namespace mixrig::render::gles

// SPDX-License-Identifier: Apache-2.0
// The shadow maps of all lamps, in one texture array.
#pragma once

#include <vector>

#include "host/render/gles/gl/gl_program.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::gles {

/// GL_TEXTURE_2D_ARRAY of window depths (gl_convention.h: near / z, 0 for nothing), one layer a
/// lamp.
class MapArray {
 public:
  /// Gives the maps the largest size among `lamps`; does nothing if they have it. Errors:
  /// kUnsupported without memory for them.
  Result<void> allocate(const std::vector<LampParams>& lamps);
  /// Clears the map of a lamp and directs draws to it, keeping the nearest surface.
  void begin(std::size_t lamp) const;

  GLuint name() const { return maps_.get(); }  ///< 0 before the first allocate()
  int size_texel() const { return size_texel_; }
  const std::vector<FramebufferHandle>& targets() const { return targets_; }

 private:
  int size_texel_ = 0;
  TextureHandle maps_;
  std::vector<FramebufferHandle> targets_;
};

/// Matrix from lamp axes to clip space of the lamp's map.
glm::mat4 clip_from_lamp(const LampParams& lamp);

}  // namespace mixrig::render::gles

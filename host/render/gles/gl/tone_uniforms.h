// SPDX-License-Identifier: Apache-2.0
// Uniforms of common/tone.glsl in a program.
#pragma once

#include "host/render/contract/tone_curve.h"
#include "host/render/gles/gl/gl_program.h"

namespace mixrig::render::gles {

class ToneUniforms {
 public:
  ToneUniforms() = default;
  explicit ToneUniforms(const Program& program)
      : gain_(program.location("gain")),
        bends_(program.location("tone_bends")),
        slope_(program.location("tone_slope")) {}
  /// Precondition: the program is in use.
  void set(const ToneCurve& tone) const {
    set_uniform(gain_, tone.gain);
    set_uniform(bends_, tone.bends);
    set_uniform(slope_, std::span<const glm::vec3>(tone.slope));
  }

 private:
  GLint gain_ = -1, bends_ = -1, slope_ = -1;
};

}  // namespace mixrig::render::gles

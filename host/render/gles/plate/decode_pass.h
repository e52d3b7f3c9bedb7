// SPDX-License-Identifier: Apache-2.0
// Pass plate of a picture that is read in its camera's memory: samples to sRGB.
#pragma once

#include "hal/base/raw_picture.h"
#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/plate/plate_import.h"

namespace mixrig::render::gles {

class DecodePass {
 public:
  /// Errors: as make_step.
  static Result<DecodePass> create(Size size);
  /// Precondition: `picture` has the size of the pass. Binds textures.
  void draw(const RawPicture& picture, const ImportedPlanes& planes);
  /// GL_SRGB8_ALPHA8, filtered.
  const Texture& color() const { return color_; }

 private:
  void set_layout(const RawPicture& picture);

  /// Locations of the uniforms.
  struct Uniforms {
    GLint is_yuyv, is_nv12, is_bayer, has_samples, size, red_at, luma, red_blue, green_shift;
  };
  Texture color_, samples_, ramp_;
  Step step_;
  Uniforms at_{};
  SampleTable table_{};  ///< that `samples_` holds
};

}  // namespace mixrig::render::gles

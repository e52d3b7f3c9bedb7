// SPDX-License-Identifier: Apache-2.0
// Pass plate for a picture in its camera's memory: turns raw samples into sRGB.
#pragma once

#include "hal/base/raw_picture.h"
#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/plate/plate_import.h"

namespace mixrig::render::gles {

class DecodePass {
 public:
  /// Errors: those of make_step.
  static Result<DecodePass> create(Size size);
  /// Decodes a picture. Precondition: `picture` has the size of the pass. Changes texture bindings.
  void draw(const RawPicture& picture, const ImportedPlanes& planes);
  /// The decoded plate, GL_SRGB8_ALPHA8, sampled linearly.
  const Texture& color() const { return color_; }

 private:
  void set_layout(const RawPicture& picture);

  /// Locations of the program's uniforms.
  struct Uniforms {
    GLint is_yuyv, is_nv12, is_bayer, has_samples, size, red_at, luma, red_blue, green_shift;
  };
  Texture color_, samples_, ramp_;
  Step step_;
  Uniforms at_{};
  SampleTable table_{};  ///< the table that `samples_` holds
};

}  // namespace mixrig::render::gles

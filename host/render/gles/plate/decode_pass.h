// SPDX-License-Identifier: Apache-2.0
// Pass plate for a picture in its camera's memory: turns raw samples into sRGB.
#pragma once

#include "hal/base/raw_picture.h"
#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/plate/plate_import.h"

namespace mixrig::render::gles {

class DecodePass {
 public:
  /// Errors: those of make_program.
  static Result<DecodePass> create();
  /// Decodes a picture into `plate`, a GL_SRGB8_ALPHA8 image of its size. Changes texture bindings.
  void draw(const RawPicture& picture, const ImportedPlanes& planes, const Target& plate);

 private:
  void set_layout(const RawPicture& picture);

  /// Locations of the program's uniforms.
  struct Uniforms {
    GLint is_yuyv, is_nv12, is_bayer, has_samples, size, red_at, luma, red_blue, green_shift;
  };
  Texture samples_, ramp_;
  Program program_;
  Uniforms at_{};
  SampleTable table_{};  ///< the table that `samples_` holds
};

}  // namespace mixrig::render::gles

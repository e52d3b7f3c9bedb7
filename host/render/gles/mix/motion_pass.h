// SPDX-License-Identifier: Apache-2.0
// Pass motion: blurs virtual things by the camera's motion during the exposure (frame_motion.h).
#pragma once

#include "host/render/frame/frame_motion.h"
#include "host/render/gles/gl/gl_step.h"

namespace mixrig::render::gles {

class MotionPass {
 public:
  static Result<MotionPass> create(const Tables& tables);
  /// Precondition: params.blurs().
  void draw(const MotionParams& params, const Texture& virtual_color,
            const Texture& virtual_w) const;

  const Texture& virtual_color() const { return color_; }  ///< in the format of LightPass'
  const Texture& virtual_w() const { return w_; }

 private:
  Texture color_, w_;
  Step step_;
  GLint turn_rad_ = -1, shift_m_ = -1, focal_px_ = -1, center_px_ = -1, nearest_w_ = -1;
};

}  // namespace mixrig::render::gles

// SPDX-License-Identifier: Apache-2.0
// Pass look: virtual things as noisy and as sharp as the plate (picture_look.h).
#pragma once

#include "host/render/frame/picture_look.h"
#include "host/render/gles/gl/gl_step.h"

namespace mixrig::render::gles {

class LookPass {
 public:
  static Result<LookPass> create(const Tables& tables);
  /// What was measured. How alike the noise of neighbours is stays as it was first.
  void set(const PictureLook& look);
  bool blurs() const { return blurs_; }
  /// LightPass' virtual colour and w, blurred. `rect`: of the virtual layer.
  void draw(const Rect& rect, const Texture& virtual_color, const Texture& virtual_w) const;

  const Texture& virtual_color() const { return color_; }  ///< as LightPass'
  const Texture& virtual_w() const { return w_; }
  const Texture* noise() const { return noise_.size.empty() ? nullptr : &noise_; }
  const Grain& grain() const { return grain_; }

 private:
  Texture across_, color_, w_, noise_;
  Step along_, down_;
  Grain grain_;
  bool blurs_ = false;
};

}  // namespace mixrig::render::gles

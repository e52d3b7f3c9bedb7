// SPDX-License-Identifier: Apache-2.0
// Pass look: gives virtual things the noise and sharpness of the plate (look_filter.h).
#pragma once

#include "host/render/frame/picture_look.h"
#include "host/render/gles/gl/gl_step.h"

namespace mixrig::render::gles {

class LookPass {
 public:
  static Result<LookPass> create(const Tables& tables);
  /// Takes a measured look. The noise table is made once and keeps the correlation of the first
  /// look.
  void set(const PictureLook& look);
  bool blurs() const { return blurs_; }
  /// Filters LightPass' virtual colour and w. `rect`: area of the virtual layer in the view.
  void draw(const Rect& rect, const Texture& virtual_color, const Texture& virtual_w) const;

  const Texture& virtual_color() const { return color_; }  ///< in the format of LightPass'
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

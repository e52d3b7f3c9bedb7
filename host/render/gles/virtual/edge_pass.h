// SPDX-License-Identifier: Apache-2.0
// Pass virtual: makes the edges of shaded objects as wide as those of the plate.
#pragma once

#include "host/render/gles/gl/gl_step.h"

namespace mixrig::render::gles {

class EdgePass {
 public:
  static Result<EdgePass> create(const Tables& tables);
  /// Filters LightPass' virtual colour and w in `rect` of the view. `tap`: weight of each of the
  /// four pixels beside one, as edge_tap() gives it.
  void draw(const Rect& rect, float tap, const Texture& sharp_color, const Texture& sharp_w) const;

  const Texture& virtual_color() const { return color_; }  ///< in the format of LightPass'
  const Texture& virtual_w() const { return w_; }

 private:
  Texture color_, w_;
  Step soften_;
  GLint edge_tap_ = -1;
};

}  // namespace mixrig::render::gles

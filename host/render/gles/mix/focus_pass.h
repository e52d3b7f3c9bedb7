// SPDX-License-Identifier: Apache-2.0
// Pass focus: depth of field of a thin lens (method: cpu/mix/focus.h).
#pragma once

#include "host/render/gles/gl/gl_step.h"

namespace mixrig::render::gles {

class FocusPass {
 public:
  /// Precondition: setup.focus is set. Errors: kUnsupported where the driver cannot draw into four
  /// floats.
  static Result<FocusPass> create(const Tables& tables, const CompositorSetup& setup);
  /// Draws from `color`, linear with the matte in alpha, and `mixed_m`, depth z; both of the view's
  /// size.
  void draw(const Focus& focus, const Texture& color, const Texture& mixed_m) const;
  /// Target of the last draw(): colour, with the matte in alpha.
  const Target& target() const { return gather_.target; }
  const Texture& color() const { return color_; }  ///< attachment of target()

 private:
  void find_plane(const Focus& focus, const Texture& mixed_m) const;

  Texture plane_w_, area_, disc_, tiles_, near_, color_;
  Step plane_, discs_, greatest_, around_, gather_;
  GLint pixel_ = -1;
};

}  // namespace mixrig::render::gles

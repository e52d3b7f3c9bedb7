// SPDX-License-Identifier: Apache-2.0
// Pass focus: the depth of field of a thin lens, as host/render/cpu/mix/focus.h says.
#pragma once

#include "host/render/gles/gl/gl_step.h"

namespace mixrig::render::gles {

class FocusPass {
 public:
  /// Errors: kUnsupported where the driver cannot draw into four floats. Precondition: setup.focus.
  static Result<FocusPass> create(const Tables& tables, const CompositorSetup& setup);
  /// `color` linear with the matte in alpha, `mixed_m` z, both of the view.
  void draw(const Focus& focus, const Texture& color, const Texture& mixed_m) const;
  /// What the last draw() drew into: the colour, with the matte in alpha.
  const Target& target() const { return gather_.target; }
  const Texture& color() const { return color_; }  ///< the same as a texture

 private:
  void find_plane(const Focus& focus, const Texture& mixed_m) const;

  Texture plane_w_, area_, disc_, tiles_, near_, color_;
  Step plane_, discs_, greatest_, around_, gather_;
  GLint pixel_ = -1;
};

}  // namespace mixrig::render::gles

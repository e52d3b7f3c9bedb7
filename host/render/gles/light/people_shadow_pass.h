// SPDX-License-Identifier: Apache-2.0
// Pass shadow for people: what they hide from the lamps (method: cpu/light/people_shadow.h).
#pragma once

#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/gl/map_array.h"

namespace mixrig::render::gles {

class PeopleShadowPass {
 public:
  static Result<PeopleShadowPass> create(const Tables& tables);
  /// Sets another view of the same size.
  void set_view(const Tables& tables) const;
  /// Draws the maps of params.people_lamps from matte and visible_w of KeyPass. Allocates in the
  /// first frame. Errors: kUnsupported without memory for the maps.
  Result<void> draw(const FrameParams& params, const Texture& matte, const Texture& visible_w);

  GLuint maps() const { return maps_.name(); }  ///< MapArray; 0 before the first draw

 private:
  Texture w_, balls_;
  Step find_w_, find_balls_;
  MapArray maps_;
  Program program_;
  GLint lamp_from_camera_ = -1, clip_from_lamp_ = -1, focal_texel_ = -1, near_m_ = -1;
};

}  // namespace mixrig::render::gles

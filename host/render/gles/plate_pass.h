// SPDX-License-Identifier: Apache-2.0
// Pass plate: upload, and the way through the lens into the view.
#pragma once

#include "host/render/gles/gl_step.h"

namespace mixrig::render::gles {

class PlatePass {
 public:
  static Result<PlatePass> create(const Tables& tables);
  void upload_plate(ImageView<const Rgb8> plate) const { upload(plate_, plate); }
  /// Plate pixel of each view pixel, for another lens. Precondition: draws().
  void upload_map(ImageView<const glm::vec2> plate_px) const { upload(map_, plate_px); }
  /// Draws where there is a lens to see through.
  void draw() const { run(step_, {&plate_, &map_, &gain_}); }
  /// Linear light when sampled, view size.
  const Texture& in_view() const { return is_view_ ? plate_ : view_; }
  bool draws() const { return !is_view_; }

 private:
  bool is_view_ = false;
  Texture plate_, map_, gain_, view_;
  Step step_;
};

}  // namespace mixrig::render::gles

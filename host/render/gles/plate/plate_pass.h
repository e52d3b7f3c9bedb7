// SPDX-License-Identifier: Apache-2.0
// Pass plate: upload, or decoding in the camera's memory, and the way through the lens into the
// view.
#pragma once

#include <optional>

#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/plate/decode_pass.h"

namespace mixrig::render::gles {

class PlatePass {
 public:
  static Result<PlatePass> create(const Tables& tables);
  /// Before the first decode(). Errors: as make_step.
  Result<void> prepare_decoding();
  void upload_plate(ImageView<const Rgb8> plate);
  /// In place of upload_plate(); draws.
  void decode(const RawPicture& picture, const ImportedPlanes& planes);
  /// Plate pixel of each view pixel, for another lens. Precondition: draws().
  void upload_map(ImageView<const glm::vec2> plate_px) const { upload(map_, plate_px); }
  /// Draws where there is a lens to see through.
  void draw() const { run(step_, {&plate(), &map_, &gain_}); }
  /// Linear light when sampled, view size.
  const Texture& in_view() const { return is_view_ ? plate() : view_; }
  bool draws() const { return !is_view_; }

 private:
  /// The newest one.
  const Texture& plate() const { return is_decoded_ ? decode_->color() : plate_; }

  bool is_view_ = false, is_decoded_ = false;
  Texture plate_, map_, gain_, view_;
  Step step_;
  std::optional<DecodePass> decode_;
};

}  // namespace mixrig::render::gles

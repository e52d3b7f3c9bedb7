// SPDX-License-Identifier: Apache-2.0
// Pass plate: uploads the plate, or decodes it from the camera's memory, and resamples it through
// the lens into the view.
#pragma once

#include <optional>

#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/gl/upload_ring.h"
#include "host/render/gles/plate/decode_pass.h"

namespace mixrig::render::gles {

class PlatePass {
 public:
  static Result<PlatePass> create(const Tables& tables);
  /// Makes the decoder; call it before the first decode(). Errors: those of make_step.
  Result<void> prepare_decoding();
  /// Errors: those of UploadRing.
  Result<void> upload_plate(ImageView<const Rgb8> plate);
  /// Decodes a plate on the GPU, instead of upload_plate().
  void decode(const RawPicture& picture, const ImportedPlanes& planes);
  /// Uploads the plate pixel of each view pixel, for another lens. Precondition: draws().
  void upload_map(ImageView<const glm::vec2> plate_px) const { upload(map_, plate_px); }
  /// Resamples the plate into the view. Precondition: draws().
  void draw() const { run(step_, {&plate(), &map_, &gain_}); }
  /// The plate in the view, linear light when sampled.
  const Texture& in_view() const { return is_view_ ? plate() : view_; }
  bool draws() const { return !is_view_; }

 private:
  /// The plate that was uploaded or decoded last.
  const Texture& plate() const { return is_decoded_ ? decode_->color() : plate_; }

  bool is_view_ = false, is_decoded_ = false;
  Texture plate_, map_, gain_, view_;
  UploadRing uploads_;
  Step step_;
  std::optional<DecodePass> decode_;
};

}  // namespace mixrig::render::gles

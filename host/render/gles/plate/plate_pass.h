// SPDX-License-Identifier: Apache-2.0
// Pass plate: uploads the plate, or decodes it from the camera's memory, and resamples it through
// the lens into the view.
#pragma once

#include <array>
#include <optional>

#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/gl/upload_ring.h"
#include "host/render/gles/plate/decode_pass.h"

namespace mixrig::render::gles {

class PlatePass {
 public:
  /// With `keeps_last`, swap() keeps a view. Errors: those of make_program and make_target.
  static Result<PlatePass> create(const Tables& tables, bool keeps_last = false);
  /// Makes the decoder; call it before the first decode(). Errors: those of DecodePass and
  /// make_target.
  Result<void> prepare_decoding();
  /// Makes in_view() last_in_view(); call it before the next plate is taken. Precondition:
  /// keeps_last.
  void swap() { now_ = 1 - now_; }
  /// Errors: those of UploadRing.
  Result<void> upload_plate(ImageView<const Rgb8> plate);
  /// Decodes a plate on the GPU, instead of upload_plate().
  void decode(const RawPicture& picture, const ImportedPlanes& planes);
  /// Uploads the plate pixel of each view pixel, for another lens. Precondition: draws().
  void upload_map(ImageView<const glm::vec2> plate_px) const { upload(map_, plate_px); }
  /// Resamples the plate into the view. Precondition: draws().
  void draw() const;
  /// The plate in the view, linear light when sampled.
  const Texture& in_view() const { return (is_view_ ? plates_ : views_)[now_]; }
  /// in_view() of before swap(). Precondition: keeps_last.
  const Texture& last_in_view() const { return (is_view_ ? plates_ : views_)[1 - now_]; }
  bool draws() const { return !is_view_; }

 private:
  std::size_t plate() const { return is_view_ ? now_ : 0; }

  bool is_view_ = false;
  std::size_t now_ = 0;
  /// The camera's picture, and that in the view; the second ones are empty unless swap() needs
  /// them.
  std::array<Texture, 2> plates_, views_;
  std::array<Target, 2> plate_targets_, view_targets_;
  Texture map_, gain_;
  UploadRing uploads_;
  Program program_;
  std::optional<DecodePass> decode_;
};

}  // namespace mixrig::render::gles

// SPDX-License-Identifier: Apache-2.0
// Pass plate: uploads the plate, or decodes it from the camera's memory, and resamples it through
// the lens into the view.
#pragma once

#include <array>
#include <optional>

#include "host/render/contract/compositor.h"
#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/gl/upload_ring.h"
#include "host/render/gles/plate/decode_pass.h"

namespace mixrig::render::gles {

class PlatePass {
 public:
  /// Errors: those of make_program and make_target.
  static Result<PlatePass> create(const CompositorSetup& setup, bool plate_is_view);
  /// Makes the decoder; call it before the first decode(). Errors: those of DecodePass and
  /// make_target.
  Result<void> prepare_decoding();
  /// Makes in_view() last_in_view(); call it before the next plate is taken. Precondition:
  /// joins_mattes(setup).
  void swap() { now_ = 1 - now_; }
  /// Errors: those of UploadRing.
  Result<void> upload_plate(ImageView<const Rgb8> plate);
  /// Decodes a plate on the GPU, instead of upload_plate().
  void decode(const RawPicture& picture, const ImportedPlanes& planes);
  /// Takes another lens and its view. Precondition: draws().
  void set_lens(const geometry::CameraModel& target, const geometry::Pinhole& view) const;
  /// Resamples the plate into the view. Precondition: draws().
  void draw() const;
  /// The plate in the view, linear light when sampled.
  const Texture& in_view() const { return (is_view_ ? plates_ : views_)[now_]; }
  /// in_view() of before swap().
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
  UploadRing uploads_;
  Program program_;
  struct {
    GLint view_focal_px, view_center_px, focal_px, center_px, lens, domain_r2;
  } at_{};
  std::optional<DecodePass> decode_;
};

}  // namespace mixrig::render::gles

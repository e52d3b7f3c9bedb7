// SPDX-License-Identifier: Apache-2.0
// Passes agree, correct and warp for a second depth camera.
#pragma once

#include "host/render/gles/plate/correct_pass.h"
#include "host/render/gles/warp/warp_pass.h"

namespace mixrig::render::gles {

class SecondDepthPass {
 public:
  /// Precondition: the setup has a second depth camera.
  static Result<SecondDepthPass> create(const CompositorSetup& setup, const Tables& tables);
  void set_view(const CompositorSetup& setup);
  void upload_depth(ImageView<const float> depth_m) const { correct_.upload_depth(depth_m); }
  /// Runs passes correct and agree for both cameras.
  void correct_both(const CorrectPass& first) const;
  /// Warps the second camera's surfaces into a view that holds those of the first.
  void add_to(const WarpPass& first) const;

 private:
  SecondTables tables_;  ///< without its images
  CorrectPass correct_;
  WarpPass warp_;
  Texture other_px_, first_px_, agreed_, first_agreed_;
  Step agree_, first_agree_;
};

}  // namespace mixrig::render::gles

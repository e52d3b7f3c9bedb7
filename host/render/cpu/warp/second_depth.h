// SPDX-License-Identifier: Apache-2.0
// Passes agree, correct and warp for a second depth camera.
#pragma once

#include "host/render/cpu/plate/correct.h"
#include "host/render/cpu/warp/warp.h"

namespace mixrig::render::cpu {

/// AgreeTables with one image a number.
struct AgreeScratch {
  AgreeScratch(const AgreeTables& tables, const Image<glm::vec2>& tof_ray);
  AgreeParams params;
  Image<float> ray_x, ray_y, ray_z;  ///< ray of each pixel, in axes of the other camera
  Image<float> other_x, other_y;     ///< AgreeTables::other_px
};

/// Pass agree: writes own.agreed_z_m and own.w from own.z_m and other.z_m. A surface that the other
/// camera measures too gets the weighted mean of both depths; one that the other camera sees
/// through becomes unknown; the rest stays.
void agree(Crew& crew, const AgreeScratch& scratch, const TofGrid& other, TofGrid& own);

/// Memory and tables of the second camera, reused from frame to frame.
class SecondDepth {
 public:
  /// Precondition: the setup has a second depth camera. Allocates pass agree's memory in `first`.
  SecondDepth(const CompositorSetup& setup, const Tables& tables, TofGrid& first);
  void set_view(const CompositorSetup& setup) { render::set_view(setup, tables_); }
  /// Runs passes correct and agree for both cameras.
  void correct_both(Crew& crew, const Tables& tables, ImageView<const float> first_m,
                    ImageView<const float> second_m, TofGrid& first);
  /// Warps the second camera's surfaces into a view that holds those of the first.
  void add_to(Crew& crew, Image<float>& view_w);

 private:
  SecondTables tables_;
  TofGrid grid_;
  AgreeScratch first_by_second_, second_by_first_;
  WarpScratch scratch_;
};

}  // namespace mixrig::render::cpu

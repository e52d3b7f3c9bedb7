// SPDX-License-Identifier: Apache-2.0
// A second depth camera: pass agree, and its part of the passes correct and warp.
#pragma once

#include "host/render/cpu/plate/correct.h"
#include "host/render/cpu/warp/warp.h"

namespace mixrig::render::cpu {

/// AgreeTables, one image a number.
struct AgreeScratch {
  AgreeScratch(const AgreeTables& tables, const Image<glm::vec2>& tof_ray);
  AgreeParams params;
  Image<float> ray_x, ray_y, ray_z;  ///< ray of each pixel in the axes of the other camera
  Image<float> other_x, other_y;     ///< AgreeTables::other_px
};

/// Pass agree: writes own.agreed_z_m and own.w from own.z_m and other.z_m. A surface that the other
/// camera measures too gets the weighted mean of both depths; what the other one sees through is
/// unknown; the rest stays.
void agree(Crew& crew, const AgreeScratch& scratch, const TofGrid& other, TofGrid& own);

/// Memory and tables of the second camera, kept between frames.
class SecondDepth {
 public:
  /// Precondition: the setup has a second depth camera. `first` gets the memory of pass agree.
  SecondDepth(const CompositorSetup& setup, const Tables& tables, TofGrid& first);
  void set_view(const CompositorSetup& setup) { render::set_view(setup, tables_); }
  /// Passes correct and agree of both cameras.
  void correct_both(Crew& crew, const Tables& tables, ImageView<const float> first_m,
                    ImageView<const float> second_m, TofGrid& first);
  /// Pass warp of the second camera, into a view that holds the surfaces of the first.
  void add_to(Crew& crew, Image<float>& view_w);

 private:
  SecondTables tables_;
  TofGrid grid_;
  AgreeScratch first_by_second_, second_by_first_;
  WarpScratch scratch_;
};

}  // namespace mixrig::render::cpu

// SPDX-License-Identifier: Apache-2.0
// Pass plate: resamples the colour camera's picture through the lens into the view, in linear
// light.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/plate/bilinear.h"
#include "host/render/cpu/plate/srgb.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// Memory of the pass. Each band of view rows decodes the plate rows that it needs, so that they
/// are read while still in the cache.
struct PlateScratch {
  /// Allocates for crews of `threads`.
  PlateScratch(const Tables& tables, int threads);
  /// Takes another lens and view of the same sizes; allocates only if its bands need more rows than
  /// ever before. Precondition: the plate is not the view itself (Tables::plate_is_view).
  void see_through(Crew& crew, const geometry::CameraModel& target, const geometry::Pinhole& view);

  static constexpr int kBandRows = 32;
  struct Rows {
    int first = 0, count = 0;
  };
  std::vector<Image<Rgbx16>> decoded;  ///< a thread's band in linear light
  std::vector<Rows> plate_rows;        ///< plate rows that each band of kBandRows needs
  Image<Tap> taps;            ///< offsets from the band's first row; empty if the plate is the view
  Image<glm::vec2> plate_px;  ///< scratch of see_through(), empty before it
  Image<std::uint16_t> gain;  ///< factor of each view pixel, 4096 = 1; empty without vignetting

 private:
  void set_band(int band, const Image<glm::vec2>& at_px);
  void size_bands();
  Size plate_size_;
};

/// Resamples `plate` into `out` (view size), and into `color` as sRGB unless that is null.
void draw_plate(Crew& crew, ImageView<const Rgb8> plate, PlateScratch& scratch, Image<Rgbx16>& out,
                Image<Rgb8>* color = nullptr);

}  // namespace mixrig::render::cpu

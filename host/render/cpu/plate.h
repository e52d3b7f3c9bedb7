// SPDX-License-Identifier: Apache-2.0
// Pass plate: the colour camera's picture through the lens into the view, in linear light.
#pragma once

#include "hal/base/parallel.h"
#include "host/render/cpu/srgb.h"
#include "host/render/prepare.h"

namespace mixrig::render::cpu {

/// Where a view pixel lies on the plate: the upper left of four pixels, and 1/256 px from there, as
/// fine as texture units of GPUs.
struct PlateTap {
  std::uint32_t offset = 0;  ///< pixels from the start of the decoded plate
  std::uint16_t fraction_x = 0, fraction_y = 0;
};

/// Memory of the pass.
struct PlateScratch {
  explicit PlateScratch(const Tables& tables);
  /// Takes another lens and view of the same sizes. Precondition: not where plate and view are one.
  void see_through(Crew& crew, const geometry::CameraModel& target, const geometry::Pinhole& view);
  Image<Rgbx16> decoded;  ///< the plate in linear light; empty where plate and view are one
  Image<PlateTap> taps;
  Image<glm::vec2> plate_px;  ///< scratch of see_through(), empty before it
  Image<std::uint16_t> gain;  ///< of each view pixel, 4096 = 1; empty without vignetting
};

/// Resamples `plate` into `out` (view size).
void draw_plate(Crew& crew, ImageView<const Rgb8> plate, PlateScratch& scratch, Image<Rgbx16>& out);

}  // namespace mixrig::render::cpu

// SPDX-License-Identifier: Apache-2.0
// Errors of the light in a room model against the true light, in all directions around one place.
#pragma once

#include <cstddef>

#include "hal/base/image.h"

namespace mixrig::measure {

/// Absolute error of luminance over the true luminance, percent; quantiles of solid angle.
struct LightError {
  std::size_t places = 0;
  double p50_pct = 0, p95_pct = 0;
  double bias_pct = 0;       ///< median of the signed error
  double saturated_pct = 0;  ///< places flagged as a lower limit; the errors leave them out
};

struct RoomLightErrors {
  LightError lamps;   ///< true luminance above 1, which is the plate's white
  LightError bright;  ///< 0.25 to 1
  LightError dim;     ///< 0.01 to 0.25
};

/// Compares pictures of one size, laid out as in room_errors(). `model` is negative where unknown,
/// `saturated` 1 where the model is a lower limit. A place counts where the true luminance differs
/// by less than 10 % within three pixels; errors at borders are errors of the geometry.
RoomLightErrors room_light_errors(ImageView<const float> model, ImageView<const float> saturated,
                                  ImageView<const float> truth);

}  // namespace mixrig::measure

// SPDX-License-Identifier: Apache-2.0
// Errors of a room's light against the light of the room, in all directions around one place.
#pragma once

#include <cstddef>

#include "hal/base/image.h"

namespace mixrig::measure {

/// Size of the error of luminance over the true one, percent; quantiles of solid angle.
struct LightError {
  std::size_t places = 0;
  double p50_pct = 0, p95_pct = 0;
  double bias_pct = 0;       ///< median with its sign
  double saturated_pct = 0;  ///< of the places, flagged as a lower limit; not in the errors
};

struct RoomLightErrors {
  LightError lamps;   ///< true luminance above 1, which is the plate's white
  LightError bright;  ///< 0.25 to 1
  LightError dim;     ///< 0.01 to 0.25
};

/// Pictures as in room_errors(), of one size; `model` is negative where it is not known,
/// `saturated` 1 where it is a lower limit. A place counts where the true luminance differs by less
/// than 10 % within three pixels: borders are those of the geometry.
RoomLightErrors room_light_errors(ImageView<const float> model, ImageView<const float> saturated,
                                  ImageView<const float> truth);

}  // namespace mixrig::measure

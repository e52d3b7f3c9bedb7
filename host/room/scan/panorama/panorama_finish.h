// SPDX-License-Identifier: Apache-2.0
// Noise and holes of a panorama. Private to this module.
#pragma once

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Replaces distances by a weighted mean of those around that lie within the noise, of pixels that
/// views agree on. On a plane the inverse distance is linear in the ray, so that is what is
/// averaged, in pairs opposite each other, over the length of the pair's mean ray. Columns near the
/// poles are closer together: the reach stays an angle. A distance that no pair shares becomes the
/// median of the pairs' means, where two thirds of these agree.
/// Rows [begin, end) of `p`; other rows may be worked on by other threads.
void smooth_rows(const Panorama& before, Panorama& p, int begin, int end);

/// One pixel inwards from every hole's border, where surfaces go on with their slope; columns go
/// around. False when no hole is left.
bool fill_border(Panorama& p, const Panorama& before);

}  // namespace mixrig::model

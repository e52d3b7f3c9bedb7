// SPDX-License-Identifier: Apache-2.0
// Reduces noise and fills holes of a panorama. Private to this module.
#pragma once

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Replaces distances by a weighted mean of those around them that lie within the noise, in pixels
/// that views agree on. The mean is of inverse distances, which on a plane are linear in the ray;
/// it is taken in pairs opposite each other, over the length of the pair's mean ray. Columns near
/// the poles are closer together, so the neighbourhood is an angle. A distance that agrees with no
/// pair becomes the median of the pairs' means, where two thirds of these agree.
/// Rows [begin, end) of `p`; other rows may be worked on by other threads.
void smooth_rows(const Panorama& before, Panorama& p, int begin, int end);

/// Fills one pixel inwards from every hole's border, continuing surfaces with their slope; columns
/// go around. False when no hole is left.
bool fill_border(Panorama& p, const Panorama& before);

}  // namespace mixrig::model

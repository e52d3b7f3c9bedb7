// SPDX-License-Identifier: Apache-2.0
// Finds mirrors in learned depth: areas whose depth has wrapped around and hangs in the air.
#pragma once

#include "hal/base/image.h"

namespace mixrig::render {

/// Copies a learned depth (metres, 0 unknown) and replaces wrapped areas by a plane through what
/// lies behind their borders. A mirror image beyond the camera's unambiguous range comes out nearer
/// than the wall around the mirror, but with the noise of its true distance. Such an area is
/// connected without steps, covers at least 0.2 % of the picture, has something farther behind four
/// fifths of its border, and its sigma over its squared depth is at least five times the picture's
/// median; real things in a room are hardly noisier than the room. `sigma_m`: sigma of one
/// measurement, of the same size; if empty, nothing is replaced. Pure; some 40 ns a pixel.
Image<float> without_wrapped(ImageView<const float> depth_m, ImageView<const float> sigma_m);

}  // namespace mixrig::render

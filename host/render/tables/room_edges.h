// SPDX-License-Identifier: Apache-2.0
// The learned depth of a room with its steps moved to the edges of the learned colours, so that
// real things hide virtual ones along the plate's edges and not along the depth camera's pixels.
#pragma once

#include "hal/base/image.h"
#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// Background depth (metres, 0 unknown) in which pixels near a depth step are given to the surface
/// around whose colours match theirs: a weighted mode (Min, Lu and Do 2012) of the inverse depths
/// within 3.5 `footprint_px` (view pixels that a ToF pixel spans), weighted by colour, distance,
/// and distance from the step; the depth is that of the plane through the agreeing samples. Pixels
/// without depth there get one where most samples agree. Other pixels, and those without a
/// majority, keep their depth. Empty without learned colours. Pure; time grows with the pixels near
/// steps.
Image<float> depth_at_color_edges(const BackgroundView& background, float footprint_px);

}  // namespace mixrig::render

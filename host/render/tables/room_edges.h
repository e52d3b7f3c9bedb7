// SPDX-License-Identifier: Apache-2.0
// The learned depth of a room with its steps where the learned colours have them: what real things
// hide of virtual ones has the plate's edges, not those of the depth camera's pixels.
#pragma once

#include "hal/base/image.h"
#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// Depth of the background (metres, 0 unknown) where pixels near a step of depth are given to the
/// surface around whose colours theirs are like: a weighted mode (Min, Lu and Do 2012) of the
/// inverse depths within 3.5 `footprint_px` (view pixels that a ToF pixel spans), by colour,
/// distance, and distance from the step; then the plane of the samples that agree. Pixels without
/// depth there get one too where most agree. Other pixels, and those of which no surface has most,
/// stay as they are. Empty without learned colours. Pure; time grows with the pixels near steps.
Image<float> depth_at_color_edges(const BackgroundView& background, float footprint_px);

}  // namespace mixrig::render

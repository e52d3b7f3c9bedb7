// SPDX-License-Identifier: Apache-2.0
// Pass focus: what both back ends share.
#pragma once

#include <vector>

#include "host/render/contract/compositor.h"
#include "host/render/contract/constants.h"

namespace mixrig::render {

/// Share of a pixel at distance d that a disc of radius r covers.
float focus_cover(float d, float r);

/// Pixels that discs cover, by radius in steps of 1/kFocusAreaSteps px, up to `most_radius`.
std::vector<float> focus_disc_areas(int most_radius);

/// Pixels that the widest disc reaches, and one more.
int focus_margin(const Focus& focus);

/// Of a frame: where it names a pixel, what is seen there is sharp. Precondition: setup.focus.
Focus focus_of(const CompositorSetup& setup, const FrameInput& input);

}  // namespace mixrig::render

// SPDX-License-Identifier: Apache-2.0
// Disc tables of pass focus, shared by both back ends.
#pragma once

#include <vector>

#include "host/render/contract/compositor.h"
#include "host/render/contract/constants.h"

namespace mixrig::render {

/// Share of a pixel, at distance d from the centre, that a disc of radius r covers; pixels.
float focus_cover(float d, float r);

/// Areas of discs in pixels, by radius in steps of 1/kFocusAreaSteps px up to `most_radius`.
std::vector<float> focus_disc_areas(int most_radius);

/// Pixels that the widest disc reaches, plus one.
int focus_margin(const Focus& focus);

/// Focus of a frame: if the frame names a pixel, the depth seen there is in focus. Precondition:
/// setup.focus is set.
Focus focus_of(const CompositorSetup& setup, const FrameInput& input);

}  // namespace mixrig::render

// SPDX-License-Identifier: Apache-2.0
// What both back ends do around a frame: look at what they get, make room for what they give.
#pragma once

#include "host/render/compositor.h"
#include "host/render/prepare.h"

namespace mixrig::render {

/// Errors: kData for pictures of a wrong size and a pose that is not finite.
Result<void> check_frame(const FrameInput& input, const Tables& tables);

/// Gives the images that will be filled the view's size; allocates only where they have another.
void size_outputs(Size view_size, FrameOutput& output);

/// Inspection: turns measured states into decided ones. The border of people is edge, the matte
/// decides the rest.
void decide_states(const Image<std::uint8_t>& matte, Image<std::uint8_t>& state);

}  // namespace mixrig::render

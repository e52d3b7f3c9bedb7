// SPDX-License-Identifier: Apache-2.0
// What both back ends do around a frame: check the input, size and hand over the images.
#pragma once

#include "host/render/contract/compositor.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// Errors: kData for pictures of a wrong size and a pose that is not finite, kUsage for what the
/// setup is not made for. `imports`: the plate is read in place, where the frame has it so.
Result<void> check_frame(const FrameInput& input, const Tables& tables, bool imports = false);

/// Wanted images and those that they are made from: the matte decides the states. A composite that
/// is to stay in the GPU's memory, but cannot, is a colour.
OutputMask with_needed(OutputMask wanted, bool shares_gpu);

/// Calls visit(bit, image of a, image of b) for each image of two frames.
template <typename A, typename B, typename Visit>
void for_each_image(A& a, B& b, Visit&& visit) {
  visit(kColor, a.color, b.color);
  visit(kMixedDepth, a.mixed_depth_m, b.mixed_depth_m);
  visit(kSegmentedDepth, a.segmented_depth_m, b.segmented_depth_m);
  visit(kMatte, a.matte, b.matte);
  visit(kWarpedDepth, a.warped_depth_m, b.warped_depth_m);
  visit(kState, a.state, b.state);
  visit(kLight, a.light, b.light);
  visit(kLayer, a.layer, b.layer);
  visit(kAlpha, a.alpha, b.alpha);
}

/// Gives the images of `which` the view's size; allocates only where they have another.
void size_outputs(Size view_size, OutputMask which, FrameOutput& output);
/// Moves the wanted images from `from` to `to`, which gives its own in exchange.
void deliver(FrameOutput& from, FrameOutput& to);

/// Passes of a frame that are skipped where no wanted image depends on them.
struct NeededPasses {
  bool key = false, light = false, mix = false;
};
/// `has_objects`: the frame shows any.
NeededPasses needed_passes(OutputMask wanted, bool has_objects, const CompositorSetup& setup);

/// Turns measured states into decided ones. The border of people is edge, the matte decides the
/// rest.
void decide_states(const Image<std::uint8_t>& matte, Image<std::uint8_t>& state);

}  // namespace mixrig::render

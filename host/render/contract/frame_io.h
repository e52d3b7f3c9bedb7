// SPDX-License-Identifier: Apache-2.0
// What both back ends do around a frame: check the input, size and hand over the images.
#pragma once

#include "host/render/contract/compositor.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// Checks a frame against the setup. `imports`: the plate is read in its camera's memory where the
/// frame has it there. Errors: kData for pictures of a wrong size and values that are not finite,
/// kUsage for what the setup was not made for.
Result<void> check_frame(const FrameInput& input, const Tables& tables, bool imports = false);

/// Adds to `wanted` the images that others are made from: kState needs the matte. Without a shared
/// GPU context kGpuColor becomes kColor.
OutputMask with_needed(OutputMask wanted, bool shares_gpu);

/// Calls visit(bit, image of a, image of b) for each kind of image.
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

/// Gives the images of `which` the view's size; allocates only where the size differs.
void size_outputs(Size view_size, OutputMask which, FrameOutput& output);
/// Swaps the wanted images of `from` into `to`, so that `from` gets the buffers of `to`.
void deliver(FrameOutput& from, FrameOutput& to);

/// Which passes a frame runs: those that a wanted image depends on.
struct NeededPasses {
  bool key = false, light = false, mix = false;
};
/// `has_objects`: the frame shows at least one object.
NeededPasses needed_passes(OutputMask wanted, bool has_objects, const CompositorSetup& setup);

/// Replaces measured states by decided ones, in place: matte 255 is foreground, a partial matte is
/// edge; elsewhere unknown stays unknown and all else is background.
void decide_states(const Image<std::uint8_t>& matte, Image<std::uint8_t>& state);

}  // namespace mixrig::render

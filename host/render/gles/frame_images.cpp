// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/frame_images.h"

#include <cmath>

#include "host/render/contract/frame_io.h"

namespace mixrig::render::gles {

void FrameImages::start(OutputMask wanted, const Passes& passes, const LightPass* light) {
  wanted_ = read_ = wanted;
  const MixPass& mix = passes.mix;
  if (!passes.key) read_ &= ~kState;
  if (!mix.has_alpha()) read_ &= ~kAlpha;
  if (light == nullptr) read_ &= ~kLight;
  const bool focuses = passes.focus && (read_ & kColor);
  const Target& colored = focuses ? passes.focus->target() : mix.target();
  if (read_ & (kColor | kMatte)) color_and_matte_.start_rgba(colored, kMixColor);
  if (read_ & kMixedDepth) mixed_.start_float(mix.target(), kMixDepth);
  if (read_ & kSegmentedDepth) segmented_.start_float(mix.target(), kMixSegmented);
  if (read_ & kWarpedDepth) warped_w_.start_float(passes.warp.target(), 0);
  if (read_ & kState) state_.start_byte(passes.key->pass().state_target(), 0);
  if (read_ & kLight) light_.start_float(light->light_target(), 0);
  if (read_ & kLayer) layer_.start_byte(mix.target(), kMixLayer);
  if (read_ & kAlpha) alpha_.start_byte(mix.alpha_target(), 0);
}

Result<void> FrameImages::fetch(FrameOutput& output) const {
  if (read_ & (kColor | kMatte))
    MIXRIG_TRY(
        color_and_matte_.fetch(read_ & kColor ? output.color.view() : ImageView<Rgb8>{},
                               read_ & kMatte ? output.matte.view() : ImageView<std::uint8_t>{}));
  if (read_ & kMixedDepth) MIXRIG_TRY(mixed_.fetch(output.mixed_depth_m));
  if (read_ & kSegmentedDepth) MIXRIG_TRY(segmented_.fetch(output.segmented_depth_m));
  if (read_ & kWarpedDepth) MIXRIG_TRY(fetch_warped_depth(output.warped_depth_m));
  if (wanted_ & kState) {
    if (read_ & kState) {
      MIXRIG_TRY(state_.fetch(output.state));
      for (int y = 0; y < output.state.height(); ++y)
        for (int x = 0; x < output.state.width(); ++x) output.state.row(y)[x] %= kStateMirrored;
    } else {
      output.state.fill(static_cast<std::uint8_t>(PixelState::kUnknown));
    }
    decide_states(output.matte, output.state);
  }
  if (read_ & kLight)
    MIXRIG_TRY(light_.fetch(output.light));
  else if (wanted_ & kLight)
    output.light.fill(1);
  if (read_ & kLayer) MIXRIG_TRY(layer_.fetch(output.layer));
  if (read_ & kAlpha)
    MIXRIG_TRY(alpha_.fetch(output.alpha));
  else if (wanted_ & kAlpha)
    output.alpha.fill(255);
  return {};
}

/// Converts the warp's inverse depth, which is negative in cut cells, to metres.
Result<void> FrameImages::fetch_warped_depth(Image<float>& depth_m) const {
  MIXRIG_TRY(warped_w_.fetch(depth_m));
  for (int y = 0; y < depth_m.height(); ++y)
    for (int x = 0; x < depth_m.width(); ++x) {
      float& value = depth_m.row(y)[x];
      value = value == 0 ? 0 : 1 / std::abs(value);
    }
  return {};
}

}  // namespace mixrig::render::gles

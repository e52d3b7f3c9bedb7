// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame_io.h"

#include <string>

namespace mixrig::render {
namespace {

Result<void> check_size(Size have, Size want, const char* what, const char* camera) {
  if (have == want) return {};
  const auto text = [](Size size) {
    return std::to_string(size.width) + " x " + std::to_string(size.height);
  };
  return Error{ErrorCode::kData, std::string("compose: the ") + what + " is " + text(have) +
                                     ", the " + camera + " camera " + text(want)};
}

template <typename T>
void size_to(Size size, Image<T>& image) {
  if (image.size() != size) image.reset(size);
}

}  // namespace

Result<void> check_frame(const FrameInput& input, const Tables& tables) {
  MIXRIG_TRY(check_size(input.plate.size, tables.plate_size, "plate", "target"));
  MIXRIG_TRY(check_size(input.tof_depth_m.size, tables.tof_size, "depth picture", "ToF"));
  if (!input.world_from_target.rotation.coeffs().allFinite() ||
      !input.world_from_target.translation_m.allFinite())
    return Error{ErrorCode::kData, "compose: the camera pose is not finite"};
  return {};
}

void size_outputs(Size view_size, FrameOutput& output) {
  size_to(view_size, output.color);
  size_to(view_size, output.mixed_depth_m);
  size_to(view_size, output.segmented_depth_m);
  size_to(view_size, output.matte);
  if (!output.inspect) return;
  size_to(view_size, output.warped_depth_m);
  size_to(view_size, output.state);
  size_to(view_size, output.light);
  size_to(view_size, output.layer);
}

void decide_states(const Image<std::uint8_t>& matte, Image<std::uint8_t>& state) {
  const auto decide = [](std::uint8_t share, std::uint8_t measured) {
    if (share == 255) return PixelState::kForeground;
    if (share > 0) return PixelState::kEdge;
    return measured == static_cast<std::uint8_t>(PixelState::kUnknown) ? PixelState::kUnknown
                                                                       : PixelState::kBackground;
  };
  for (int y = 0; y < matte.height(); ++y)
    for (int x = 0; x < matte.width(); ++x)
      state.row(y)[x] = static_cast<std::uint8_t>(decide(matte.row(y)[x], state.row(y)[x]));
}

}  // namespace mixrig::render

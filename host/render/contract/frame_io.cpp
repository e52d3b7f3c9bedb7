// SPDX-License-Identifier: Apache-2.0
#include "host/render/contract/frame_io.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace mixrig::render {
namespace {

Result<void> check_size(Size have, Size want, const char* what, const char* camera) {
  if (have == want) return {};
  const auto text = [](Size size) { return fmt::format("{} x {}", size.width, size.height); };
  return Error{
      ErrorCode::kData,
      fmt::format("compose: the {} is {}, the {} camera {}: pass pictures of the size that "
                  "the compositor was made for",
                  what, text(have), camera, text(want))};
}

/// Checks the lens of one frame for size and finite values: geometry::validate() has checked the
/// table of lenses, and is too slow for every frame.
Result<void> check_lens(const geometry::LensState& lens, const Tables& tables) {
  if (!tables.lens_moves)
    return Error{ErrorCode::kUsage,
                 "compose: a frame has its own lens, but the compositor was made for one lens: set "
                 "CompositorSetup::lens_moves"};
  const geometry::Pinhole& p = lens.camera.pinhole;
  MIXRIG_TRY(check_size(p.size_px, tables.plate_size, "lens of the frame", "target"));
  const geometry::Lens::Coefficients& k = lens.camera.lens.coefficients();
  const bool finite = std::isfinite(p.fx_px + p.fy_px + p.cx_px + p.cy_px + lens.pupil_shift_m) &&
                      std::all_of(k.begin(), k.end(), [](double v) { return std::isfinite(v); });
  if (finite && p.fx_px > 0 && p.fy_px > 0) return {};
  return Error{
      ErrorCode::kData,
      "compose: the lens of the frame has a value that is not finite, or a focal length that is "
      "not positive: calibrate the lens again, or check its encoders"};
}

Result<void> check_light(const FrameLight& light) {
  const auto is_light = [](const glm::vec3& v) {
    return v.r >= 0 && v.g >= 0 && v.b >= 0 && std::isfinite(v.r + v.g + v.b);
  };
  const bool good = is_light(light.ambient) && light.exposure > 0 &&
                    std::isfinite(light.exposure) &&
                    std::all_of(light.intensity.begin(), light.intensity.end(), is_light);
  if (good) return {};
  return Error{ErrorCode::kData,
               "compose: the light of the frame is negative or not finite: check [light]"};
}

template <typename T>
void size_to(Size size, Image<T>& image) {
  if (image.size() != size) image.reset(size);
}

}  // namespace

Result<void> check_frame(const FrameInput& input, const Tables& tables, bool imports) {
  const bool in_place = imports && input.shared != nullptr;
  MIXRIG_TRY(check_size(in_place ? input.shared->raw().size : input.plate.size, tables.plate_size,
                        "plate", "target"));
  MIXRIG_TRY(check_size(input.tof_depth_m.size, tables.tof_size, "depth picture", "ToF"));
  if (!input.tof2_depth_m.empty())
    MIXRIG_TRY(check_size(input.tof2_depth_m.size, tables.tof2_size, "second depth picture",
                          "second ToF"));
  if (!input.objects_shown && !tables.may_hide_objects)
    return Error{ErrorCode::kUsage,
                 "compose: a frame hides the objects, but the compositor was made to show them: "
                 "set CompositorSetup::may_hide_objects"};
  if (!input.world_from_target.rotation.coeffs().allFinite() ||
      !input.world_from_target.translation_m.allFinite())
    return Error{ErrorCode::kData,
                 "compose: the camera's pose is not finite: check the pose source"};
  for (const geometry::Pose& pose : input.world_from_object)
    if (!pose.rotation.coeffs().allFinite() || !pose.translation_m.allFinite())
      return Error{ErrorCode::kData,
                   "compose: the pose of an object is not finite: check its position and rotation"};
  if (input.light) MIXRIG_TRY(check_light(*input.light));
  if (const auto& m = input.motion;
      m && !(std::isfinite(glm::dot(m->turn_rad, m->turn_rad) + glm::dot(m->shift_m, m->shift_m))))
    return Error{ErrorCode::kData,
                 "compose: the motion of the camera is not finite: check the pose source"};
  if (const auto& at = input.focus_pixel;
      at && (at->x < 0 || at->y < 0 || at->x >= tables.view_size.width ||
             at->y >= tables.view_size.height))
    return Error{ErrorCode::kData,
                 "compose: the pixel in focus lies outside the view: give one in the picture"};
  return input.lens ? check_lens(*input.lens, tables) : Result<void>();
}

OutputMask with_needed(OutputMask wanted, bool shares_gpu) {
  if (wanted & kState) wanted |= kMatte;
  return (wanted & kGpuColor) && !shares_gpu ? (wanted & ~kGpuColor) | kColor : wanted;
}

void size_outputs(Size view_size, OutputMask which, FrameOutput& output) {
  for_each_image(output, output, [&](OutputMask bit, auto& image, auto&) {
    if (which & bit) size_to(view_size, image);
  });
}

void deliver(FrameOutput& from, FrameOutput& to) {
  to.wanted = from.wanted;
  for_each_image(from, to, [&](OutputMask bit, auto& made, auto& delivered) {
    if (from.wanted & bit) std::swap(made, delivered);
  });
}

NeededPasses needed_passes(OutputMask wanted, bool has_objects, const CompositorSetup& setup) {
  NeededPasses needed;
  const OutputMask color = kColor | kGpuColor;
  needed.light = has_objects && (wanted & (color | kLight));
  // With neither objects nor backdrop the colour is the plate; without objects the light map is 1.
  const OutputMask without_people = kWarpedDepth | kLight | (setup.backdrop ? 0 : color | kAlpha);
  needed.key = needed.light || (wanted & ~without_people);
  needed.mix = wanted & (color | kMixedDepth | kSegmentedDepth | kLayer | kAlpha);
  return needed;
}

Result<void> Compositor::compose(const FrameInput& input, FrameOutput& output) {
  if (in_flight() > 0)
    return Error{ErrorCode::kUsage, "compose: other frames are in flight: collect them first"};
  MIXRIG_TRY(submit(input, output.wanted));
  return collect(output);
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

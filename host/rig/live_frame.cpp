// SPDX-License-Identifier: Apache-2.0
#include "host/rig/live_frame.h"

#include <cmath>
#include <numbers>

#include "host/rig/decode.h"

namespace mixrig::rig {
namespace {

geometry::CameraModel guess(Size size) {
  const double focal_px = 0.5 * size.width / std::tan(std::numbers::pi / 6);
  return {.pinhole = {.size_px = size,
                      .fx_px = focal_px,
                      .fy_px = focal_px,
                      .cx_px = 0.5 * (size.width - 1),
                      .cy_px = 0.5 * (size.height - 1)},
          .lens = {}};
}

geometry::CameraModel depth_model(const device::DepthCamera& depth) {
  geometry::CameraModel model = guess(depth.info().size);
  if (const auto& told = depth.depth().intrinsics) {
    model.pinhole.fx_px = model.pinhole.fy_px = told->focal_px;
    model.pinhole.cx_px = told->principal_x_px;
    model.pinhole.cy_px = told->principal_y_px;
  }
  return model;
}

/// What is known without rig.toml.
take::TakeInfo info_of_devices(const Devices& devices) {
  take::TakeInfo info;
  if (devices.player) {
    const take::TakeInfo& played = devices.player->info();
    info.target = played.target;
    info.tof = played.tof;
    info.view = played.view;
    info.target_from_tof = played.target_from_tof;
    info.noise = played.noise;
    info.calibration = played.calibration;
  }
  // A recording may stand for one of the cameras only.
  const Size color = devices.cameras.front()->info().size, depth = devices.depth->info().size;
  if (info.target.size_px() != color) {
    info.target = guess(color);
    info.view.reset();
  }
  if (info.tof.size_px() != depth) info.tof = depth_model(*devices.depth);
  return info;
}

void fill_amplitude(const device::Frame& depth, Image<float>& amplitude) {
  if (depth.amplitude.size() < 2 * depth.size.area()) return;
  if (amplitude.size() != depth.size) amplitude.reset(depth.size);
  const std::uint8_t* in = depth.amplitude.data();
  for (int y = 0; y < depth.size.height; ++y)
    for (int x = 0; x < depth.size.width; ++x, in += 2)
      amplitude.row(y)[x] = static_cast<float>(in[0] | in[1] << 8);
}

}  // namespace

Result<take::TakeInfo> take_info(const RigConfig& config, const Devices& devices) {
  if (devices.cameras.empty() || !devices.depth)
    return Error{ErrorCode::kUsage,
                 "a take needs a [[camera]] and a [depth] camera: add them to rig.toml"};
  take::TakeInfo info = info_of_devices(devices);
  info.name = config.name;
  if (config.target) {
    info.target = *config.target;
    info.view.reset();
  }
  if (!config.calibration.empty()) info.calibration = config.calibration;
  if (config.tof) info.tof = *config.tof;
  if (config.target_from_tof) info.target_from_tof = *config.target_from_tof;
  const device::DepthInfo& depth = devices.depth->depth();
  info.depth_kind =
      depth.meaning == device::DepthMeaning::kZ ? take::DepthKind::kZ : take::DepthKind::kDistance;
  info.depth_unit_m = depth.metres_per_step;
  info.depth_unknown = 0;
  const TriggerLine* line = config.line_of(config.cameras.front());
  info.color.rate_hz =
      line != nullptr ? 100.0 / line->channel.divider : devices.cameras.front()->info().rate_hz;
  info.depth.rate_hz = info.color.rate_hz;
  return info;
}

Result<void> to_take_frame(const LiveSet& set, const Devices& devices, take::TakeFrame& frame) {
  const device::FramePtr& color = set.frames.frames[0].frame;
  const device::FramePtr& depth = set.frames.frames[devices.cameras.size()].frame;
  if (!color || !depth)
    return Error{ErrorCode::kData, "a moment without colour or depth: left out"};
  MIXRIG_TRY(decode_rgb8(*color, frame.color));
  MIXRIG_TRY(device::to_metres(*depth, devices.depth->depth(), frame.depth_m));
  fill_amplitude(*depth, frame.amplitude);
  return {};
}

geometry::Pose world_from_target(const RigConfig& config, const Devices& devices) {
  if (config.world_from_target) return *config.world_from_target;
  return devices.player ? devices.player->world_from_target() : geometry::Pose{};
}

}  // namespace mixrig::rig

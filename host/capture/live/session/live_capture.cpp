// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/live_capture.h"

#include <cmath>
#include <numbers>

#include "host/capture/capture/fisheye.h"

namespace mixrig::live {
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

/// Returns the model that the device reports, else a guess.
geometry::CameraModel depth_model(const device::DepthCamera& depth) {
  geometry::CameraModel model = guess(depth.info().size);
  if (const auto& reported = depth.depth().intrinsics) {
    model.pinhole.fx_px = model.pinhole.fy_px = reported->focal_px;
    model.pinhole.cx_px = reported->principal_x_px;
    model.pinhole.cy_px = reported->principal_y_px;
  }
  return model;
}

/// Returns the cameras without the values of rig.toml.
take::TakeInfo info_of_devices(const Devices& devices) {
  take::TakeInfo info;
  if (devices.player) {
    const capture::SourceInfo& played = devices.player->info();
    info.target = played.target;
    info.tof = played.tof;
    info.view = played.view;
    info.target_from_tof = played.target_from_tof;
    info.noise = played.noise;
    info.amplitude_is_light = played.amplitude_is_light;
    info.calibration = played.calibration;
    info.true_poses = played.true_poses;
  }
  // A recording may replace only one of the cameras.
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

capture::ColorDecoder decoder_of(const RigConfig& config, const Devices& devices,
                                 std::size_t camera) {
  if (camera >= config.cameras.size() || camera >= devices.cameras.size())
    return capture::ColorDecoder();
  return capture::ColorDecoder(
      color_settings(config.cameras[camera], devices.cameras[camera]->info()));
}

Result<void> describe_fisheye(const RigConfig& config, const Devices& devices,
                              take::TakeInfo& info) {
  info.fisheye.reset(), info.fisheye_px = {}, info.fisheye_rate_hz = 0;
  const std::size_t index = fisheye_index(config);
  if (index == 0) return {};
  info.fisheye_px = devices.cameras[index]->info().size;
  info.fisheye_rate_hz = fisheye_rate_hz(config, devices);
  info.fisheye.emplace().rate_hz = info.fisheye_rate_hz;
  if (info.fisheye_rate_hz > 0) return {};
  return Error{ErrorCode::kUsage,
               config.file.string() +
                   ": the fisheye does not report its frame rate: give it a rate_hz or a "
                   "trigger_line"};
}

/// Returns the delay of a triggered camera's stamp after that of the colour camera; 0 if unknown.
double delay_after_color_s(const RigConfig& config, const CameraConfig& depth) {
  const CameraConfig& color = config.cameras.front();
  const TriggerLine *line = config.line_of(depth), *first = config.line_of(color);
  if (line == nullptr || first == nullptr) return 0;
  const double period_s = 0.01 * line->channel.divider;
  const double after_s =
      seconds(line->channel.phase + depth.delay) - seconds(first->channel.phase + color.delay);
  return std::remainder(after_s, period_s);
}

void describe_second_depth(const RigConfig& config, const Devices& devices, take::TakeInfo& info) {
  if (!devices.depth2) return;
  capture::SecondDepthCamera camera;
  if (devices.player && devices.player->info().tof2) camera = *devices.player->info().tof2;
  if (camera.model.size_px() != devices.depth2->info().size)
    camera.model = depth_model(*devices.depth2);
  if (config.tof2) camera.model = *config.tof2, info.camera_tables.emplace_back("tof2");
  if (config.target_from_tof2) {
    camera.target_from_tof = *config.target_from_tof2;
    info.camera_tables.emplace_back("target_from_tof2");
  }
  const device::DepthInfo steps = config.depth2_steps.applied_to(devices.depth2->depth());
  camera.kind = steps.meaning == device::DepthMeaning::kZ ? capture::DepthKind::kZ
                                                          : capture::DepthKind::kDistance;
  camera.unit_m = steps.metres_per_step, camera.offset_m = steps.offset_m;
  camera.unknown = steps.unknown_steps.front();
  camera.noise = config.depth2_steps.noise.value_or(camera.noise);
  camera.amplitude_is_light = steps.amplitude_is_light;
  info.tof2 = camera;
  take::SecondDepthStream& streams = info.depth2.emplace();
  streams.depth.rate_hz = info.color.rate_hz;
  streams.depth.delay_s = delay_after_color_s(config, *config.depth2);
  streams.amplitude = take::StreamInfo{};
}

}  // namespace

Result<take::TakeInfo> take_info(const RigConfig& config, const Devices& devices) {
  if (devices.cameras.empty() || !devices.depth)
    return Error{ErrorCode::kUsage,
                 "the rig needs a [[camera]] and a [depth] camera: add them to rig.toml"};
  take::TakeInfo info = info_of_devices(devices);
  info.name = config.name;
  info.file = config.file;
  info.reported = devices.player || devices.depth->depth().intrinsics;
  if (config.target) {
    info.target = *config.target;
    info.view.reset();
  }
  if (!config.calibration.empty()) info.calibration = config.calibration;
  info.has_lens_values = !config.lens_uri.empty();
  if (config.target) info.camera_tables.emplace_back("target");
  if (config.tof) info.camera_tables.emplace_back("tof");
  if (config.target_from_tof) info.camera_tables.emplace_back("target_from_tof");
  if (config.tof) info.tof = *config.tof;
  if (config.target_from_tof) info.target_from_tof = *config.target_from_tof;
  const device::DepthInfo depth = depth_info(config, devices);
  info.depth_kind = depth.meaning == device::DepthMeaning::kZ ? capture::DepthKind::kZ
                                                              : capture::DepthKind::kDistance;
  info.depth_unit_m = depth.metres_per_step;
  info.depth_offset_m = depth.offset_m;
  info.depth_unknown = depth.unknown_steps.front();
  info.noise = config.depth_steps.noise.value_or(info.noise);
  info.amplitude_is_light = depth.amplitude_is_light;
  const TriggerLine* line = config.line_of(config.cameras.front());
  info.color.rate_hz =
      line != nullptr ? 100.0 / line->channel.divider : devices.cameras.front()->info().rate_hz;
  info.rate_hz = info.depth.rate_hz = info.color.rate_hz;
  info.exposure_s = config.cameras.front().exposure_s.value_or(0);
  MIXRIG_TRY(describe_fisheye(config, devices, info));
  describe_second_depth(config, devices, info);
  return info;
}

std::size_t fisheye_index(const RigConfig& config) {
  for (std::size_t i = 1; i < config.cameras.size(); ++i)
    if (config.cameras[i].name == kFisheye) return i;
  return 0;
}

double fisheye_rate_hz(const RigConfig& config, const Devices& devices) {
  const std::size_t index = fisheye_index(config);
  if (index == 0) return 0;
  const CameraConfig& camera = config.cameras[index];
  if (const TriggerLine* line = config.line_of(camera)) return 100.0 / line->channel.divider;
  const double rate_hz = devices.cameras[index]->info().rate_hz;
  return rate_hz > 0 ? rate_hz : camera.request.rate_hz;
}

device::DepthInfo depth_info(const RigConfig& config, const Devices& devices) {
  return config.depth_steps.applied_to(devices.depth->depth());
}

capture::ColorSettings color_settings(const CameraConfig& config, const device::CameraInfo& info) {
  const ColorConfig& color = config.color;
  capture::ColorSettings settings{.encoding = info.color, .gains = color.white_gains};
  settings.encoding.transfer = color.transfer.value_or(info.color.transfer);
  if (color.transfer) settings.encoding.gamma = color.gamma;
  settings.encoding.matrix = color.matrix.value_or(info.color.matrix);
  settings.encoding.range = color.range.value_or(info.color.range);
  const bool yuv = info.format == device::PixelFormat::kYuyv ||
                   info.format == device::PixelFormat::kNv12 ||
                   info.format == device::PixelFormat::kMjpeg;
  settings.limited_samples = !yuv && settings.encoding.range == device::SampleRange::kLimited;
  settings.mirrored = info.mirrored;
  settings.black = color.black_level / ((1 << info.sample_bits) - 1);
  return settings;
}

SetDecoder::SetDecoder(const RigConfig& config, const Devices& devices, WithoutDepth without_depth)
    : devices_(devices),
      depth_(devices.depth ? depth_info(config, devices) : device::DepthInfo()),
      depth2_(devices.depth2 ? config.depth2_steps.applied_to(devices.depth2->depth())
                             : device::DepthInfo()),
      plate_(decoder_of(config, devices, 0)),
      fisheye_decoder_(decoder_of(config, devices, fisheye_index(config))),
      fisheye_(fisheye_index(config)),
      fisheye_hold_(capture::fisheye_hold(fisheye_rate_hz(config, devices))),
      without_depth_(without_depth) {}

Result<void> SetDecoder::decode(const LiveSet& set, capture::Capture& capture) {
  using capture::Stream;
  using capture::StreamStatus;
  const sync::TimedFrame& plate = set.frames.frames[0];
  const bool has_depth = set.frames.frames[devices_.cameras.size()].frame != nullptr;
  const bool goes_without = without_depth_ == WithoutDepth::kHold && last_depth_;
  if (!plate.frame || !(has_depth || goes_without))
    return Error{ErrorCode::kData, "a frame set without colour or depth: skipped"};
  MIXRIG_TRY(decode_plate(plate.frame, capture));
  capture.tick = devices_.trigger || devices_.edges ? set.frames.tick : 0;
  capture.mid_exposure = plate.mid_exposure;
  capture.pan_tilt = set.pan_tilt;
  capture.status = {};
  capture.set_status(Stream::kPlate, StreamStatus::kFresh);
  MIXRIG_TRY(decode_depth(set, capture));
  if (devices_.pan_tilt)
    capture.set_status(Stream::kPanTilt,
                       set.pan_tilt ? StreamStatus::kFresh : StreamStatus::kMissing);
  if (devices_.depth2) decode_second_depth(set, capture);
  if (fisheye_ > 0) decode_fisheye(set, capture);
  return {};
}

/// Decodes the plate in the requested forms.
Result<void> SetDecoder::decode_plate(const device::FramePtr& frame, capture::Capture& capture) {
  const capture::PlateForms forms = forms_;
  capture.picture.reset();
  if (forms.shared && frame->memory) {
    std::shared_ptr<capture::CameraPicture> picture = pictures_.take();
    if (picture->hold(frame, plate_)) capture.picture = std::move(picture);
  }
  if (forms.decoded || !capture.picture) return plate_.decode(*frame, capture.plate);
  capture.plate.reset({});
  return {};
}

/// Decodes the set's depth, or keeps the last one for kDepthHold, or clears it.
Result<void> SetDecoder::decode_depth(const LiveSet& set, capture::Capture& capture) {
  using capture::StreamStatus;
  sync::TimedFrame depth = set.frames.frames[devices_.cameras.size()];
  if (!depth.frame && held_depth_.frame &&
      capture.mid_exposure - held_depth_.mid_exposure <= kDepthHold)
    depth = held_depth_;
  if (without_depth_ == WithoutDepth::kHold) held_depth_ = depth;
  if (!depth.frame) {
    capture.depth_m = {}, capture.amplitude = {};
    capture.depth_mid_exposure = capture.mid_exposure;
    capture.set_status(capture::Stream::kDepth, StreamStatus::kMissing);
    return {};
  }
  MIXRIG_TRY(device::to_metres(*depth.frame, depth_, capture.depth_m));
  fill_amplitude(*depth.frame, capture.amplitude);
  capture.set_status(capture::Stream::kDepth, last_depth_ == depth.frame->sequence
                                                  ? StreamStatus::kRepeated
                                                  : StreamStatus::kFresh);
  last_depth_ = depth.frame->sequence;
  capture.depth_mid_exposure = depth.mid_exposure;
  return {};
}

/// Decodes the second depth. A frame without it is composited with the first depth camera alone.
void SetDecoder::decode_second_depth(const LiveSet& set, capture::Capture& capture) {
  using capture::StreamStatus;
  const sync::TimedFrame& timed = set.frames.frames[devices_.cameras.size() + 1];
  capture::DepthPicture& out = capture.depth2;
  out.mid_exposure = timed.mid_exposure;
  if (!timed.frame || !device::to_metres(*timed.frame, depth2_, out.depth_m)) {
    out.depth_m.reset({}), out.amplitude.reset({});
    return capture.set_status(capture::Stream::kDepth2, StreamStatus::kMissing);
  }
  fill_amplitude(*timed.frame, out.amplitude);
  capture.set_status(capture::Stream::kDepth2, last_depth2_ == timed.frame->sequence
                                                   ? StreamStatus::kRepeated
                                                   : StreamStatus::kFresh);
  last_depth2_ = timed.frame->sequence;
}

void SetDecoder::decode_fisheye(const LiveSet& set, capture::Capture& capture) {
  const sync::TimedFrame& timed = set.frames.frames[fisheye_];
  if (!timed.frame) return capture::lose_fisheye(capture);
  const capture::StreamStatus status =
      capture::fisheye_status(last_fisheye_ != timed.frame->sequence, capture.mid_exposure,
                              timed.mid_exposure, fisheye_hold_);
  if (status == capture::StreamStatus::kMissing ||
      !fisheye_decoder_.decode(*timed.frame, capture.fisheye))
    return capture::lose_fisheye(capture);
  capture.fisheye_mid_exposure = timed.mid_exposure;
  capture.fisheye_counter = last_fisheye_.emplace(timed.frame->sequence);
  capture.set_status(capture::Stream::kFisheye, status);
}

void set_pose(const RigConfig& config, const Devices& devices, const LiveSet& set,
              capture::Capture& capture) {
  if (config.world_from_target) {
    capture.world_from_target = *config.world_from_target;
    capture.pose_origin = capture::PoseOrigin::kFixed;
    return;
  }
  Player::PlayedPose played;
  if (devices.player) played = devices.player->pose_of(set.frames.frames[0].frame->sequence);
  capture.world_from_target = played.world_from_target;
  capture.pose_origin = played.origin;
}

}  // namespace mixrig::live

// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/sweep/sweep_rig.h"

#include <algorithm>

namespace mixrig::live {
namespace {

constexpr double kUnknownRate_hz = 10;  ///< lowest rate that is assumed for an unknown one

Duration period_of(const RigConfig& config, const CameraConfig& camera,
                   const device::CameraInfo& info) {
  double rate_hz = info.rate_hz > 0 ? info.rate_hz : kUnknownRate_hz;
  if (const TriggerLine* line = config.line_of(camera)) rate_hz = 100.0 / line->channel.divider;
  return Duration(static_cast<long>(1e9 / rate_hz));
}

HostTime exposure_begin(const sync::TimedFrame& frame, Duration period) {
  const Duration exposure = frame.frame->exposure;
  return frame.mid_exposure - (exposure > Duration{} ? exposure : period) / 2;
}

}  // namespace

ExposureBegin::ExposureBegin(const RigConfig& config, const Devices& devices)
    : color_period_(period_of(config, config.cameras.front(), devices.cameras.front()->info())),
      depth_period_(period_of(config, *config.depth, devices.depth->info())),
      depth_(devices.cameras.size()) {}

HostTime ExposureBegin::of(const LiveSet& set) const {
  const HostTime color = exposure_begin(set.frames.frames[0], color_period_);
  const sync::TimedFrame& depth = set.frames.frames[depth_];
  return depth.frame ? std::min(color, exposure_begin(depth, depth_period_)) : color;
}

LiveSweepRig::LiveSweepRig(const RigConfig& config, const Devices& devices, LiveSession& session)
    : devices_(devices), session_(session), decoder_(config, devices), begin_(config, devices) {}

Result<bool> LiveSweepRig::next(Duration timeout, capture::Capture& frame, HostTime& exposed_from) {
  const bool ended = session_.ended();
  const auto set = session_.next(ended ? Duration(0) : timeout);
  if (!set && ended)
    return Error{ErrorCode::kDevice,
                 "the cameras have ended or failed: check them with mixrig diag, then run the same "
                 "command again"};
  if (!set) return false;
  if (!decoder_.decode(*set, frame)) {
    ++left_out_;
    return false;
  }
  exposed_from = begin_.of(*set);
  return true;
}

}  // namespace mixrig::live

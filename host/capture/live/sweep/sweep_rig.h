// SPDX-License-Identifier: Apache-2.0
// The live session as a SweepRig.
#pragma once

#include "host/capture/live/session/live_capture.h"
#include "host/capture/live/sweep/sweep.h"

namespace mixrig::live {

/// Computes when the exposures of a set began. An exposure that the driver does not report counts
/// as the time from frame to frame.
class ExposureBegin {
 public:
  /// Precondition: there are a camera and a depth camera.
  ExposureBegin(const RigConfig& config, const Devices& devices);
  /// Returns the start of the earlier exposure of colour and depth; of colour if depth is missing.
  /// Precondition: the set has colour.
  HostTime of(const LiveSet& set) const;
  Duration color_period() const { return color_period_; }  ///< from frame to frame

 private:
  Duration color_period_, depth_period_;
  std::size_t depth_;  ///< index of the depth camera's stream
};

/// A SweepRig on a running session with a camera, a depth camera and a head. Config, devices and
/// session must outlive it.
class LiveSweepRig final : public SweepRig {
 public:
  LiveSweepRig(const RigConfig& config, const Devices& devices, LiveSession& session);
  device::PanTiltAngles step() const override { return devices_.pan_tilt->info().resolution; }
  Result<void> move_to(device::PanTiltAngles target) override { return session_.move_head(target); }
  Result<void> halt() override { return session_.halt_head(); }
  Result<bool> next(Duration timeout, capture::Capture& frame, HostTime& exposed_from) override;
  /// Time from frame to frame of the colour camera.
  Duration color_period() const { return begin_.color_period(); }
  std::uint64_t left_out() const { return left_out_; }  ///< sets without colour or depth

 private:
  const Devices& devices_;
  LiveSession& session_;
  SetDecoder decoder_;
  ExposureBegin begin_;
  std::uint64_t left_out_ = 0;
};

}  // namespace mixrig::live

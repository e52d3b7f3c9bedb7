// SPDX-License-Identifier: Apache-2.0
// A source of plain captures whose times, poses and angles a test sets.
#pragma once

#include <functional>
#include <utility>

#include "host/capture/capture/capture_source.h"

namespace mixrig::test {

/// Frames of 64x48 px at 25 Hz with a grey wall at 3 m; both cameras are one ideal camera of 60 px
/// focal length.
class PosedSource final : public capture::CaptureSource {
 public:
  static constexpr double kFocal_px = 60, kCentre_px = 31.5;
  using Describe = std::function<void(capture::Capture&)>;
  /// Gives `frames` captures, then ends. With `live` it reports itself as endless.
  PosedSource(int frames, Describe describe, bool live = false)
      : frames_(frames), describe_(std::move(describe)) {
    info_.name = "posed";
    info_.target.pinhole = {{64, 48}, kFocal_px, kFocal_px, kCentre_px, 23.5};
    info_.tof = info_.target;
    info_.noise = {0.002, 0, 0};
    info_.frames = live ? capture::kEndless : frames;
  }
  const capture::SourceInfo& info() const override { return info_; }
  void tell_true_poses() { info_.true_poses = true; }
  Result<bool> read(int number, capture::Capture& capture) override {
    if (number > frames_) return false;
    capture.number = number;
    capture.time_s = (number - 1) / 25.0;
    capture.mid_exposure = HostTime(std::chrono::milliseconds(40) * (number - 1));
    capture.plate.reset(info_.target.size_px(), {128, 128, 128});
    capture.depth_m.reset(info_.tof.size_px(), 3.0F);
    if (describe_) describe_(capture);
    return true;
  }
  Result<void> read_truth(int, capture::Truth&) override {
    return Error{ErrorCode::kData, "no truth"};
  }

 private:
  const int frames_;
  const Describe describe_;
  capture::SourceInfo info_;
};

}  // namespace mixrig::test

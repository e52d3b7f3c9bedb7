// SPDX-License-Identifier: Apache-2.0
// A synthetic recording to be played as devices.
#pragma once

#include <functional>
#include <memory>

#include "host/capture/capture/capture_source.h"

namespace mixrig::test {

/// Frame k: colour (k, 100, 200) everywhere, depth k centimetres along z; 16x12 px, 25 Hz.
class MadeRecording final : public capture::CaptureSource {
 public:
  explicit MadeRecording(int frames) {
    info_.name = "made";
    info_.frames = frames;
    info_.rate_hz = 25;
    info_.target.pinhole = {{16, 12}, 20, 20, 7.5, 5.5};
    info_.tof = info_.target;
  }
  const capture::SourceInfo& info() const override { return info_; }
  capture::SourceInfo& info() { return info_; }
  Result<bool> read(int number, capture::Capture& capture) override {
    capture.number = number;
    capture.time_s = (number - 1) / 25.0;
    capture.plate.reset({16, 12}, {static_cast<std::uint8_t>(number), 100, 200});
    capture.depth_m.reset({16, 12}, 0.01F * static_cast<float>(number));
    capture.world_from_target.translation_m = {1, 2, 3};
    capture.pose_origin = capture::PoseOrigin::kRecorded;
    if (damage) MIXRIG_TRY(damage(number, capture));
    return true;
  }
  Result<void> read_truth(int, capture::Truth&) override {
    return Error{ErrorCode::kData, "no truth"};
  }
  /// Called at the end of read(), where set.
  std::function<Result<void>(int number, capture::Capture& capture)> damage;

 private:
  capture::SourceInfo info_;
};

}  // namespace mixrig::test

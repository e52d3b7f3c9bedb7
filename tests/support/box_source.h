// SPDX-License-Identifier: Apache-2.0
// A small source: a grey wall, with a red box in front after some empty frames.
#pragma once

#include "host/capture/capture/capture_source.h"

namespace mixrig::test {

/// Frames of 64x48 px; both cameras are one ideal camera. The wall is at 3 m. From frame `empty` +
/// 1 on a box of 24x24 px at 2 m has its top left corner at (20, 12).
class BoxSource final : public capture::CaptureSource {
 public:
  static constexpr int kLeft = 20, kTop = 12, kSide = 24;
  explicit BoxSource(int empty, int frames, bool moves = false) : empty_(empty) {
    info_.name = "box";
    info_.target.pinhole = {{64, 48}, 60, 60, 31.5, 23.5};
    info_.tof = info_.target;
    info_.noise = {0.002, 0, 0};
    info_.frames = frames;
    info_.has_truth = true;
    info_.moves = moves;
  }
  const capture::SourceInfo& info() const override { return info_; }
  int fails_at = 0;  ///< frame that cannot be read
  int ends_at = 0;   ///< frame before which the source ends

  Result<bool> read(int number, capture::Capture& frame) override {
    if (number == ends_at) return false;
    if (number == fails_at) return Error{ErrorCode::kData, "depth/000005.png: truncated"};
    frame.number = number;
    frame.plate.reset(info_.target.size_px(), {128, 128, 128});
    frame.depth_m.reset(info_.tof.size_px(), 3.0F);
    if (number > empty_) {
      paint(frame.plate, Rgb8{200, 30, 30});
      paint(frame.depth_m, 2.0F);
    }
    return true;
  }
  Result<void> read_truth(int number, capture::Truth& truth) override {
    capture::Capture frame;
    MIXRIG_ASSIGN(const bool there, read(number, frame));
    if (!there) return Error{ErrorCode::kData, "the source has ended"};
    truth.composite = frame.plate;
    truth.depth_m = frame.depth_m;
    truth.light.reset(frame.plate.size(), 1.0F);
    truth.matte.reset(frame.plate.size());
    truth.labels.reset(frame.plate.size(), capture::Truth::kTofSees);
    if (number > empty_) {
      paint(truth.matte, std::uint8_t{255});
      paint(truth.labels, std::uint8_t{capture::Truth::kTofSees | 1});
    }
    return {};
  }

 private:
  template <typename T>
  static void paint(Image<T>& image, T value) {
    for (int y = kTop; y < kTop + kSide; ++y) std::fill_n(image.row(y) + kLeft, kSide, value);
  }
  int empty_;
  capture::SourceInfo info_;
};

}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/unwrapped_source.h"

#include <gtest/gtest.h>

namespace mixrig::capture {
namespace {

/// A wall at 3 m; in one pixel something at 1 m that returns as little light as from 9 m.
class LitSource final : public CaptureSource {
 public:
  explicit LitSource(bool light) {
    info_.tof.pinhole = {{64, 48}, 60, 60, 31.5, 23.5};
    info_.amplitude_is_light = light;
    info_.frames = 2;
  }
  const SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, Capture& capture) override {
    if (number > 2) return false;
    capture.depth_m.reset(info_.tof.size_px(), 3.0F);
    capture.amplitude.reset(number == 1 ? info_.tof.size_px() : Size{}, 900.0F);
    capture.depth_m.at(30, 20) = 1;
    if (number == 1) capture.amplitude.at(30, 20) = 100;
    return true;
  }
  Result<void> read_truth(int, Truth&) override { return {}; }

 private:
  SourceInfo info_;
};

TEST(UnwrappedSource, LeavesOutWhatReturnsTooLittleLight) {
  const auto source = without_wrapped_depth(std::make_unique<LitSource>(true));
  Capture capture;
  ASSERT_TRUE(*source->read(1, capture));
  EXPECT_EQ(capture.depth_m.at(30, 20), 0);
  EXPECT_EQ(capture.depth_m.at(31, 20), 3);
  ASSERT_TRUE(*source->read(2, capture));
  EXPECT_EQ(capture.depth_m.at(30, 20), 1) << "a frame without amplitudes";
  EXPECT_FALSE(*source->read(3, capture));
}

TEST(UnwrappedSource, LeavesAConfidenceAlone) {
  const auto source = without_wrapped_depth(std::make_unique<LitSource>(false));
  Capture capture;
  ASSERT_TRUE(*source->read(1, capture));
  EXPECT_EQ(capture.depth_m.at(30, 20), 1);
}

}  // namespace
}  // namespace mixrig::capture

// SPDX-License-Identifier: Apache-2.0
// The contract of Camera. A driver's test instantiates it with its own maker.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/device/camera.h"

namespace mixrig::test {

/// A camera under test and a function that produces `count` frames (waits for real devices).
struct CameraUnderTest {
  std::unique_ptr<device::Camera> camera;
  std::function<void(int count)> expose;
};

struct CameraMaker {
  std::string name;
  std::function<CameraUnderTest()> make;
  friend void PrintTo(const CameraMaker& maker, std::ostream* out) { *out << maker.name; }
};

class CameraContract : public ::testing::TestWithParam<CameraMaker> {
 protected:
  void SetUp() override {
    under_test_ = GetParam().make();
    ASSERT_TRUE(under_test_.camera) << GetParam().name << " cannot be opened";
  }
  device::Camera& camera() { return *under_test_.camera; }
  void expose(int count) { under_test_.expose(count); }
  device::FrameSink collect() {
    return [this](const device::FramePtr& frame) {
      const std::lock_guard lock(mutex_);
      if (!frame) return void(++empty_);
      seen_.push_back(
          {frame->sequence, frame->received, frame->size, frame->format, frame->bytes.size()});
    };
  }
  struct Seen {
    std::uint64_t sequence;
    HostTime received;
    Size size;
    device::PixelFormat format;
    std::size_t bytes;
  };
  std::vector<Seen> seen() {
    const std::lock_guard lock(mutex_);
    return seen_;
  }

 private:
  CameraUnderTest under_test_;
  std::mutex mutex_;
  std::vector<Seen> seen_;
  int empty_ = 0;
};

TEST_P(CameraContract, InfoIsComplete) {
  EXPECT_FALSE(camera().info().uri.empty());
  EXPECT_FALSE(camera().info().size.empty());
  EXPECT_NE(camera().info().format, device::PixelFormat::kUnknown);
  EXPECT_EQ(camera().health().state, device::DeviceState::kStopped);
}

TEST_P(CameraContract, DeliversFramesInOrderInTheAnnouncedFormat) {
  ASSERT_TRUE(camera().start(collect()));
  expose(3);
  camera().stop();
  const auto frames = seen();
  ASSERT_GE(frames.size(), 3U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].size, camera().info().size);
    EXPECT_EQ(frames[i].format, camera().info().format);
    EXPECT_GT(frames[i].bytes, 0U);
    if (i == 0) continue;
    EXPECT_GT(frames[i].sequence, frames[i - 1].sequence);
    EXPECT_GE(frames[i].received, frames[i - 1].received);
  }
  EXPECT_EQ(camera().health().frames, frames.size());
}

TEST_P(CameraContract, DeliversNothingAfterStop) {
  ASSERT_TRUE(camera().start(collect()));
  expose(1);
  camera().stop();
  const auto before = seen().size();
  expose(2);
  EXPECT_EQ(seen().size(), before);
  EXPECT_EQ(camera().health().state, device::DeviceState::kStopped);
}

TEST_P(CameraContract, StartsAgainAfterStop) {
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(camera().start(collect()));
    expose(2);
    camera().stop();
    camera().stop();  // has no effect
  }
  EXPECT_GE(seen().size(), 4U);
}

TEST_P(CameraContract, RefusesASecondStart) {
  ASSERT_TRUE(camera().start(collect()));
  const auto again = camera().start(collect());
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kUsage);
  camera().stop();
}

TEST_P(CameraContract, ControlsKeepTheirValuesAndRefuseOthersOutOfRange) {
  for (int i = 0; i < device::kCameraControls; ++i) {
    const auto control = static_cast<device::CameraControl>(i);
    const device::ControlRange* range = nullptr;
    for (const auto& r : camera().info().controls)
      if (r.control == control) range = &r;
    if (range == nullptr) {
      const auto set = camera().set(control, 1);
      ASSERT_FALSE(set);
      EXPECT_EQ(set.error().code, ErrorCode::kUnsupported);
      continue;
    }
    const double middle = (range->minimum + range->maximum) / 2;
    ASSERT_TRUE(camera().set(control, middle));
    EXPECT_NEAR(*camera().get(control), middle, range->step + 1e-3 * std::abs(middle));
    const auto beyond = camera().set(control, range->maximum * 2 + 1);
    ASSERT_FALSE(beyond);
    EXPECT_EQ(beyond.error().code, ErrorCode::kUsage);
  }
}

}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
// The contract of DepthCamera. A driver's test instantiates it with its own maker.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/device/depth_camera.h"

namespace mixrig::test {

/// A depth camera under test and a function that produces `count` frames. If the camera runs, the
/// frames have been delivered when the function returns.
struct DepthCameraUnderTest {
  std::unique_ptr<device::DepthCamera> camera;
  std::function<void(int count)> expose;
  std::shared_ptr<void> keep{};  ///< what must outlive the camera
};

struct DepthCameraMaker {
  std::string name;
  std::function<DepthCameraUnderTest()> make;
  friend void PrintTo(const DepthCameraMaker& maker, std::ostream* out) { *out << maker.name; }
};

class DepthCameraContract : public ::testing::TestWithParam<DepthCameraMaker> {
 protected:
  void SetUp() override {
    under_test_ = GetParam().make();
    ASSERT_TRUE(under_test_.camera) << GetParam().name << " cannot be opened";
  }
  void TearDown() override { under_test_.camera.reset(); }
  device::DepthCamera& camera() { return *under_test_.camera; }
  void expose(int count) { under_test_.expose(count); }
  /// Keeps metres and the counter of each frame.
  device::FrameSink collect() {
    return [this](const device::FramePtr& frame) {
      const std::lock_guard lock(mutex_);
      sequences_.push_back(frame->sequence);
      formats_.push_back(frame->format);
      if (frame->flags & device::kFrameIncomplete) return;
      EXPECT_TRUE(device::to_metres(*frame, camera().depth(), metres_));
    };
  }
  DepthCameraUnderTest under_test_;
  std::mutex mutex_;
  std::vector<std::uint64_t> sequences_;
  std::vector<device::PixelFormat> formats_;
  Image<float> metres_;
};

TEST_P(DepthCameraContract, InfoIsComplete) {
  EXPECT_FALSE(camera().info().uri.empty());
  EXPECT_FALSE(camera().info().size.empty());
  EXPECT_EQ(camera().info().format, device::PixelFormat::kDepth16);
  EXPECT_GT(camera().depth().metres_per_step, 0.0);
  EXPECT_EQ(camera().health().state, device::DeviceState::kStopped);
}

TEST_P(DepthCameraContract, FramesAreStepsThatBecomeMetres) {
  ASSERT_TRUE(camera().start(collect()));
  expose(3);
  camera().stop();
  const std::uint64_t delivered = camera().health().frames;
  const std::lock_guard lock(mutex_);
  ASSERT_GE(sequences_.size(), 3U);
  for (std::size_t i = 1; i < sequences_.size(); ++i) EXPECT_GT(sequences_[i], sequences_[i - 1]);
  for (const auto format : formats_) EXPECT_EQ(format, device::PixelFormat::kDepth16);
  EXPECT_EQ(metres_.size(), camera().info().size);
  EXPECT_EQ(delivered, sequences_.size());
}

TEST_P(DepthCameraContract, DeliversNothingAfterStopAndStartsAgain) {
  ASSERT_TRUE(camera().start(collect()));
  expose(1);
  camera().stop();
  camera().stop();  // has no effect
  const auto count = [this] {
    const std::lock_guard lock(mutex_);
    return sequences_.size();
  };
  const auto before = count();
  EXPECT_GE(before, 1U);
  expose(1);
  EXPECT_EQ(count(), before);
  EXPECT_EQ(camera().health().state, device::DeviceState::kStopped);
  ASSERT_TRUE(camera().start(collect()));
  expose(2);
  camera().stop();
  EXPECT_GE(count(), before + 2);
}

TEST_P(DepthCameraContract, RefusesASecondStart) {
  ASSERT_TRUE(camera().start(collect()));
  const auto again = camera().start(collect());
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kUsage);
  camera().stop();
}

}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
// A recording as devices: the contracts of cameras, and the properties of playing.
#include "host/live/player.h"

#include "tests/support/made_playable.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"
#include "tests/unit/hal_device/camera_contract.h"
#include "tests/unit/hal_device/depth_camera_contract.h"

namespace mixrig::test {
namespace {

using namespace std::chrono_literals;

std::shared_ptr<live::Player> make_player(Clock& clock, int frames) {
  auto player = live::Player::create(std::make_unique<MadeRecording>(frames), "take:made", clock);
  EXPECT_TRUE(player);
  return *player;
}

/// Advances time until that many more frames were delivered.
template <typename Device>
std::function<void(int)> expose_on(std::shared_ptr<SteppedClock> clock, Device* camera) {
  return [clock, camera](int count) {
    const auto wanted = camera->health().frames + static_cast<std::uint64_t>(count);
    for (int i = 0; i < count; ++i) clock->advance(40ms);
    if (camera->health().state == device::DeviceState::kStopped) return;
    EXPECT_TRUE(comes_true([&] { return camera->health().frames >= wanted; }));
  };
}

CameraUnderTest make_color() {
  auto clock = std::make_shared<SteppedClock>();
  auto camera = make_player(*clock, 1000)->camera();
  auto* raw = camera.get();
  return {std::move(camera), expose_on(clock, raw)};
}
DepthCameraUnderTest make_depth() {
  auto clock = std::make_shared<SteppedClock>();
  auto camera = make_player(*clock, 1000)->depth();
  auto* raw = camera.get();
  return {std::move(camera), expose_on(clock, raw), clock};
}

INSTANTIATE_TEST_SUITE_P(Played, CameraContract,
                         ::testing::Values(CameraMaker{"played", make_color}),
                         [](const auto& maker) { return maker.param.name; });
INSTANTIATE_TEST_SUITE_P(Played, DepthCameraContract,
                         ::testing::Values(DepthCameraMaker{"played", make_depth}),
                         [](const auto& maker) { return maker.param.name; });

struct Got {
  std::uint64_t sequence;
  DeviceTime at;
  std::uint8_t red;
};

class PlayerTest : public ::testing::Test {
 protected:
  device::FrameSink keep(std::vector<Got>& into) {
    return [this, &into](const device::FramePtr& frame) {
      const std::lock_guard lock(mutex_);
      into.push_back({frame->sequence, frame->device_time, frame->bytes[0]});
    };
  }
  ThreadedClock clock_;
  std::mutex mutex_;
  std::vector<Got> color_, depth_;
};

TEST_F(PlayerTest, ColourAndDepthOfAMomentShareCounterAndStamp) {
  const auto player = make_player(clock_, 50);
  const auto color = player->camera();
  const auto depth = player->depth();
  ASSERT_TRUE(color->start(keep(color_)));
  EXPECT_EQ(color->health().frames, 0U) << "it waits for the depth camera";
  ASSERT_TRUE(depth->start(keep(depth_)));
  ASSERT_TRUE(comes_true([&] { return depth->health().state == device::DeviceState::kStopped; }));
  ASSERT_EQ(color_.size(), 50U);
  ASSERT_EQ(depth_.size(), 50U);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(color_[i].sequence, i + 1);
    EXPECT_EQ(depth_[i].sequence, i + 1);
    EXPECT_EQ(color_[i].at, depth_[i].at);
    EXPECT_EQ(color_[i].red, i + 1);
    EXPECT_GE(color_[i].at - color_[0].at, static_cast<long>(i) * 40ms);
  }
}

TEST_F(PlayerTest, ADamagedFrameEndsItAsFailed) {
  auto recording = std::make_unique<MadeRecording>(50);
  recording->damage = [](int number, capture::Capture&) -> Result<void> {
    if (number == 7) return Error{ErrorCode::kData, "frame 7: truncated"};
    return {};
  };
  const auto player = *live::Player::create(std::move(recording), "take:made", clock_);
  const auto color = player->camera();
  ASSERT_TRUE(color->start(keep(color_)));
  ASSERT_TRUE(comes_true([&] { return color->health().state == device::DeviceState::kFailed; }));
  EXPECT_EQ(color_.size(), 6U);
}

TEST_F(PlayerTest, AFrameOfAnotherSizeEndsItAndWritesNowhere) {
  auto recording = std::make_unique<MadeRecording>(50);
  recording->damage = [](int number, capture::Capture& capture) -> Result<void> {
    if (number == 7) capture.plate.reset({640, 480});
    return {};
  };
  const auto player = *live::Player::create(std::move(recording), "take:made", clock_);
  const auto color = player->camera();
  ASSERT_TRUE(color->start(keep(color_)));
  ASSERT_TRUE(comes_true([&] { return color->health().state == device::DeviceState::kFailed; }));
  EXPECT_EQ(color_.size(), 6U);
}

TEST_F(PlayerTest, NothingToPlayIsRefused) {
  EXPECT_FALSE(live::Player::create(std::make_unique<MadeRecording>(0), "take:made", clock_));
  auto still = std::make_unique<MadeRecording>(5);
  still->info().rate_hz = 0;
  EXPECT_FALSE(live::Player::create(std::move(still), "take:made", clock_));
}

}  // namespace
}  // namespace mixrig::test

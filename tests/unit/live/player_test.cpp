// SPDX-License-Identifier: Apache-2.0
// A recording as devices: the contracts of cameras, and the properties of playing.
#include "host/capture/live/play/player.h"

#include <map>

#include "tests/support/made_playable.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"
#include "tests/support/throw_in.h"
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

TEST_F(PlayerTest, WhatItsThreadThrowsIsAFailureOfItsDevices) {
  const ThrowIn thrown("playing");
  const auto player = make_player(clock_, 50);
  const auto color = player->camera();
  const auto depth = player->depth();
  ASSERT_TRUE(color->start(keep(color_)));
  ASSERT_TRUE(depth->start(keep(depth_)));
  EXPECT_TRUE(comes_true([&] { return color->health().state == device::DeviceState::kFailed; }));
  EXPECT_EQ(depth->health().state, device::DeviceState::kFailed);
}

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

/// A fisheye of 8x6 px and 10 Hz, its first picture 15 ms before frame 4: the counter grows by 2,
/// and the picture 10 ms after frame 9 comes after it.
std::unique_ptr<MadeRecording> with_fisheye(int frames) {
  auto recording = std::make_unique<MadeRecording>(frames);
  recording->info().fisheye_rate_hz = 10;
  recording->damage = [](int number, capture::Capture& capture) -> Result<void> {
    using capture::StreamStatus;
    capture.mid_exposure = HostTime((number - 1) * 40ms);
    const std::map<int, Duration> after{{4, -15ms}, {6, 5ms}, {9, 10ms}, {11, -5ms}};
    const auto own = after.find(number);
    capture.set_status(capture::Stream::kFisheye,
                       own == after.end() ? StreamStatus::kMissing : StreamStatus::kFresh);
    capture.fisheye.reset({});
    if (own == after.end()) return {};
    capture.fisheye.reset({8, 6}, {static_cast<std::uint8_t>(100 + number), 0, 0});
    capture.fisheye_mid_exposure = capture.mid_exposure + own->second;
    capture.fisheye_counter = static_cast<std::uint64_t>(70 + 2 * number);
    return {};
  };
  return recording;
}

TEST_F(PlayerTest, ItsFisheyePlaysAtItsOwnTimesWithItsOwnCounters) {
  const auto player = *live::Player::create(with_fisheye(12), "take:made", clock_);
  const auto color = player->camera();
  const auto fisheye = player->fisheye();
  ASSERT_TRUE(fisheye) << fisheye.error().context;
  EXPECT_EQ((*fisheye)->info().uri, "take:made/fisheye");
  EXPECT_EQ((*fisheye)->info().size, (Size{8, 6}));
  EXPECT_EQ((*fisheye)->info().rate_hz, 10);
  ASSERT_TRUE(color->start(keep(color_)));
  EXPECT_EQ(color->health().frames, 0U) << "it waits for the fisheye";
  ASSERT_TRUE((*fisheye)->start(keep(depth_)));
  ASSERT_TRUE(comes_true([&] { return color->health().state == device::DeviceState::kStopped; }));
  EXPECT_EQ((*fisheye)->health().state, device::DeviceState::kStopped);
  ASSERT_EQ(color_.size(), 12U);
  ASSERT_EQ(depth_.size(), 4U);
  const std::array<int, 4> frames{4, 6, 9, 11};
  const std::array<Duration, 4> after{-15ms, 5ms, 10ms, -5ms};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(depth_[i].sequence, 70U + 2U * static_cast<unsigned>(frames[i]));
    EXPECT_EQ(depth_[i].red, 100 + frames[i]);
    EXPECT_EQ(depth_[i].at - color_[static_cast<std::size_t>(frames[i] - 1)].at, after[i]);
  }
  EXPECT_EQ(color_[0].red, 1) << "looking for the first picture skips no frame";
}

TEST_F(PlayerTest, ARecordingWithoutAFisheyeSaysSo) {
  const auto none = make_player(clock_, 5)->fisheye();
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kData);
  EXPECT_NE(none.error().context.find("--fisheye"), std::string::npos);
}

/// The head of a recording turns by 0.1 rad a frame.
std::unique_ptr<MadeRecording> turning(int frames) {
  auto recording = std::make_unique<MadeRecording>(frames);
  recording->damage = [](int number, capture::Capture& capture) -> Result<void> {
    capture.pan_tilt = {0.1 * number, -0.2 * number};
    return {};
  };
  return recording;
}

TEST_F(PlayerTest, ItsHeadTurnsWithThePictures) {
  SteppedClock clock;
  const auto player = *live::Player::create(turning(4), "take:made", clock);
  const auto head = player->pan_tilt();
  ASSERT_TRUE(head) << head.error().context;
  EXPECT_EQ((*head)->info().uri, "take:made/head");
  const auto color = player->camera();
  const auto pan_rad = [&] { return (*head)->sample()->angles.pan_rad; };
  EXPECT_NEAR(pan_rad(), 0.1, 1e-12) << "before it plays";
  ASSERT_TRUE(color->start(keep(color_)));
  const HostTime begin = clock.now();
  clock.advance(10ms);  // the second frame is read while the first one is shown
  ASSERT_TRUE(comes_true([&] { return pan_rad() > 0.12; }));
  const auto sample = (*head)->sample();
  ASSERT_TRUE(sample);
  EXPECT_NEAR(sample->angles.pan_rad, 0.1 + 0.025, 1e-9);
  EXPECT_NEAR(sample->angles.tilt_rad, -0.2 - 0.05, 1e-9);
  EXPECT_EQ(sample->pan_at, begin + 10ms);
  clock.advance(110ms + 1s);
  ASSERT_TRUE(comes_true([&] { return color->health().state == device::DeviceState::kStopped; }));
  const auto last = (*head)->sample();
  EXPECT_NEAR(last->angles.pan_rad, 0.4, 1e-12);
  EXPECT_EQ(last->pan_at, clock.now()) << "it stands still there";
  EXPECT_EQ((*head)->move_to({}).error().code, ErrorCode::kUnsupported);
}

TEST(PlayedAngles, AreNotOlderThanTheySayWhereTheRecordingIsReadTooSlowly) {
  live::PlayedAngles angles({0.5, 0});
  const HostTime begin(1s);
  EXPECT_EQ(angles.at(begin).angles.pan_rad, 0.5);
  angles.add(begin, {1, 0});
  angles.add(begin + 40ms, {2, 0});
  const auto late = angles.at(begin + 90ms);
  EXPECT_EQ(late.angles.pan_rad, 2);
  EXPECT_EQ(late.pan_at, begin + 40ms);
  angles.add(begin + 80ms, {3, 0});
  angles.add(begin + 120ms, {4, 0});
  EXPECT_NEAR(angles.at(begin + 90ms).angles.pan_rad, 3.25, 1e-12);
}

TEST_F(PlayerTest, ARecordingWithoutAnglesHasNoHead) {
  const auto head = make_player(clock_, 5)->pan_tilt();
  ASSERT_FALSE(head);
  EXPECT_EQ(head.error().code, ErrorCode::kData);
  EXPECT_NE(head.error().context.find("pan_tilt.csv"), std::string::npos);
}

TEST_F(PlayerTest, BeginsAtTheTimeThatIsGiven) {
  const auto player = make_player(clock_, 3);
  const HostTime begin = clock_.now() + 7s;
  player->play_at(begin);
  const auto color = player->camera();
  ASSERT_TRUE(color->start(keep(color_)));
  ASSERT_TRUE(comes_true([&] { return color->health().state == device::DeviceState::kStopped; }));
  ASSERT_EQ(color_.size(), 3U);
  EXPECT_EQ(color_[0].at, DeviceTime(begin.time_since_epoch()));
  const auto late = make_player(clock_, 3);
  late->play_at(clock_.now() - 1ms);
  const auto started = late->camera()->start(keep(depth_));
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, ErrorCode::kUsage);
  EXPECT_NE(started.error().context.find("play_at_s"), std::string::npos);
}

TEST_F(PlayerTest, NothingToPlayIsRefused) {
  EXPECT_FALSE(live::Player::create(std::make_unique<MadeRecording>(0), "take:made", clock_));
  auto still = std::make_unique<MadeRecording>(5);
  still->info().rate_hz = 0;
  EXPECT_FALSE(live::Player::create(std::move(still), "take:made", clock_));
}

}  // namespace
}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
// A head that commands move, and pictures rendered at its angles.
#include "host/capture/live/play/steered_head.h"

#include <cmath>

#include <gtest/gtest.h>

#include "host/capture/live/play/player.h"
#include "tests/support/made_playable.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"
#include "tests/unit/hal_device/pan_tilt_contract.h"

namespace mixrig::live {
namespace {

using namespace std::chrono_literals;

constexpr double kUnitStep_rad = 0.01;

device::PanTiltInfo unit() {
  return {"unit", "", {kUnitStep_rad, kUnitStep_rad}, {-1, -0.5}, {1, 0.5}};
}

TEST(SteeredMotion, TurnsAtItsSpeedAndSwingsWhereItStops) {
  SteeredMotion motion(unit());
  motion.set_speed(0.5);
  const HostTime begin(10s);
  ASSERT_TRUE(motion.move_to({0.5, -0.25}, begin));
  EXPECT_EQ(motion.at(begin).angles.pan_rad, 0);
  const capture::HeadMotion half = motion.at(begin + 250ms);
  EXPECT_NEAR(half.angles.pan_rad, 0.125, 1e-12);
  EXPECT_NEAR(half.angles.tilt_rad, -0.125, 1e-12);
  EXPECT_NEAR(half.rate_rad_s.tilt_rad, -0.5, 1e-12);
  EXPECT_EQ(half.swing_rad, 0);
  const capture::HeadMotion tilted = motion.at(begin + 700ms);
  EXPECT_EQ(tilted.angles.tilt_rad, -0.25);
  EXPECT_EQ(tilted.rate_rad_s.tilt_rad, 0);
  EXPECT_NEAR(tilted.rate_rad_s.pan_rad, 0.5, 1e-12);
  EXPECT_GT(std::abs(motion.at(begin + 1030ms).swing_rad), 1e-3);
  EXPECT_LT(std::abs(motion.at(begin + 2s).swing_rad), 1e-6);
}

TEST(SteeredMotion, ATimeBeforeTheNewestCommandIsThatOfTheOneBefore) {
  SteeredMotion motion(unit());
  motion.set_speed(1);
  ASSERT_TRUE(motion.move_to({0.5, 0}, HostTime(10s)));
  ASSERT_TRUE(motion.move_to({-0.5, 0}, HostTime(10s) + 300ms));
  EXPECT_NEAR(motion.at(HostTime(10s) + 200ms).angles.pan_rad, 0.2, 1e-12);
  EXPECT_NEAR(motion.at(HostTime(10s) + 400ms).angles.pan_rad, 0.2, 1e-12);
  motion.halt(HostTime(10s) + 405ms);
  EXPECT_NEAR(motion.at(HostTime(12s)).angles.pan_rad, 0.2, 0.51 * kUnitStep_rad);
}

TEST(SteeredMotion, BeyondItsLimitsNothingMoves) {
  SteeredMotion motion(unit());
  const auto moved = motion.move_to({0, 0.6}, HostTime(1s));
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, ErrorCode::kUsage);
  EXPECT_EQ(motion.at(HostTime(9s)).angles.tilt_rad, 0);
}

test::PanTiltUnderTest make_steered() {
  auto clock = std::make_shared<ManualClock>();
  auto* raw = clock.get();
  device::PanTiltInfo info = unit();
  info.version = "made", info.resolution = {0.001, 0.001}, info.maximum.pan_rad = 2.5;
  return {make_steered_head(std::make_shared<SteeredMotion>(info), *clock), raw, std::move(clock)};
}

/// Red is the pan in hundredths of a radian.
class TurnedRecording final : public capture::CaptureSource, public capture::RenderedHead {
 public:
  const capture::SourceInfo& info() const override { return made_.info(); }
  Result<bool> read(int number, capture::Capture& capture) override {
    MIXRIG_TRY(made_.read(number, capture));
    const auto red = static_cast<std::uint8_t>(std::lround(100 * motion_.angles.pan_rad));
    capture.plate.reset({16, 12}, {red, 0, 0});
    return true;
  }
  Result<void> read_truth(int, capture::Truth&) override { return Error{ErrorCode::kData, ""}; }
  capture::RenderedRig rendered() override { return {.head = this}; }
  void turn(const capture::HeadMotion& motion) override { motion_ = motion; }
  device::PanTiltInfo limits() const override { return unit(); }

 private:
  test::MadeRecording made_{1000};
  capture::HeadMotion motion_;
};

TEST(SteeredHead, ThePicturesAreThoseOfWhereItStoodAtTheirTime) {
  test::SteppedClock clock;
  auto made = Player::create(std::make_unique<TurnedRecording>(), "studio:made", clock);
  ASSERT_TRUE(made) << made.error().context;
  auto head = (*made)->pan_tilt();
  ASSERT_TRUE(head) << head.error().context;
  EXPECT_EQ((*head)->info().uri, "studio:made/head");
  ASSERT_TRUE((*head)->set_motion({.speed_rad_s = 0.5, .acceleration_rad_s2 = 0}));
  const auto camera = (*made)->camera();
  std::mutex mutex;
  std::vector<std::pair<DeviceTime, int>> got;
  ASSERT_TRUE(camera->start([&](const device::FramePtr& frame) {
    const std::lock_guard lock(mutex);
    got.emplace_back(frame->device_time, frame->bytes[0]);
  }));
  const HostTime begin = clock.now();
  ASSERT_TRUE((*head)->move_to({0.5, 0}));
  for (std::uint64_t frames = 2; frames < 30; ++frames) {
    clock.advance(40ms);
    ASSERT_TRUE(test::comes_true([&] { return camera->health().frames >= frames; }));
  }
  camera->stop();
  EXPECT_EQ(got[0].second, 0);
  EXPECT_EQ(got.back().second, 50);
  for (const auto& [at, red] : got) {
    const double since_s = seconds(at.time_since_epoch() - begin.time_since_epoch());
    EXPECT_NEAR(red, std::min(50.0, 50 * since_s), 0.51);
  }
  EXPECT_NEAR((*head)->sample()->angles.pan_rad, 0.5, 1e-12);
}

}  // namespace
}  // namespace mixrig::live

namespace mixrig::test {
namespace {

INSTANTIATE_TEST_SUITE_P(Steered, PanTiltContract,
                         ::testing::Values(PanTiltMaker{"steered", live::make_steered}),
                         [](const auto& maker) { return maker.param.name; });

}  // namespace
}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
// Plates at other exposures of a camera whose control takes effect frames later, in injected time.
#include "host/capture/live/sweep/bracket.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"

namespace mixrig::live {
namespace {

using namespace std::chrono_literals;

constexpr Size kShotSize{96, 64};
constexpr double kRest_s = 8e-3;

/// Its exposure as it was set, with every fault.
class ControlledCamera final : public device::Camera {
 public:
  ControlledCamera() {
    info_.uri = "test:camera";
    info_.controls = {{device::CameraControl::kExposure, 1e-4, 0.1, 1e-5}};
  }
  const device::CameraInfo& info() const override { return info_; }
  Result<void> start(device::FrameSink) override { return {}; }
  void stop() override {}
  Result<void> set(device::CameraControl, double value) override {
    sets.push_back(value);
    if (refuses && value != kRest_s) return Error{ErrorCode::kDevice, "test:camera: refused"};
    if (!deaf) exposure_s = value;
    return {};
  }
  Result<double> get(device::CameraControl) override { return lies ? kRest_s : sets.back(); }
  device::StreamHealth health() const override { return {}; }

  device::CameraInfo info_;
  std::vector<double> sets{kRest_s};
  double exposure_s = kRest_s;
  bool refuses = false;  ///< other values than that at rest
  bool deaf = false;     ///< says what it was told, and does not do it
  bool lies = false;     ///< says another value
};

/// Frames that show what was set `latency` frames before.
class ExposedRig final : public SweepRig {
 public:
  ExposedRig(ManualClock& clock, ControlledCamera& camera) : clock_(clock), camera_(camera) {}
  device::PanTiltAngles step() const override { return {1e-3, 1e-3}; }
  Result<void> move_to(device::PanTiltAngles) override { return {}; }
  Result<void> halt() override { return {}; }
  Result<bool> next(Duration, capture::Capture& frame, HostTime& exposed_from) override {
    clock_.advance(period);
    if (++frames == fails_at) return Error{ErrorCode::kDevice, "the cameras have ended"};
    if (frames == stops_at) stop = true;
    pending_.push_back(camera_.exposure_s);
    const std::size_t at = pending_.size() > latency ? pending_.size() - 1 - latency : 0;
    exposed_from = clock_.now() - 20ms;
    draw(pending_[at], frame.plate);
    return true;
  }
  void draw(double exposure_s, Image<Rgb8>& plate) const {
    plate.reset(kShotSize);
    for (int y = 0; y < kShotSize.height; ++y)
      for (int x = 0; x < kShotSize.width; ++x) {
        const double light = x < 20 && y < 12 ? lamp : surface * std::pow(90, x / 95.0);
        const std::uint8_t v =
            srgb_byte_from_linear(static_cast<float>(light * exposure_s / kRest_s));
        plate.at(x, y) = {v, v, v};
      }
  }
  Image<Rgb8> plate() const {
    Image<Rgb8> at_rest;
    draw(kRest_s, at_rest);
    return at_rest;
  }

  Duration period = 40ms;
  std::size_t latency = 3;
  double lamp = 12, surface = 0.01;
  int frames = 0, fails_at = std::numeric_limits<int>::max(),
      stops_at = std::numeric_limits<int>::max();
  std::atomic<bool> stop = false;

 private:
  ManualClock& clock_;
  ControlledCamera& camera_;
  std::vector<double> pending_{kRest_s};
};

class Bracket : public ::testing::Test {
 protected:
  Result<std::vector<capture::BracketPlate>> take() {
    auto bracket = ExposureBracket::create(camera_, 40ms);
    EXPECT_TRUE(bracket) << bracket.error().context;
    return bracket->take(rig_, rig_.plate(), rig_.stop, clock_);
  }
  void expect_at_rest() const { EXPECT_EQ(camera_.sets.back(), kRest_s); }

  ManualClock clock_;
  ControlledCamera camera_;
  ExposedRig rig_{clock_, camera_};
};

TEST_F(Bracket, GoesDownUntilNothingSaturatesAndIsPutBack) {
  const auto taken = take();
  ASSERT_TRUE(taken) << taken.error().context;
  ASSERT_EQ(taken->size(), 2U * ExposureBracket::kPlates);
  for (std::size_t i = 0; i < taken->size(); ++i) {
    const capture::BracketPlate& plate = (*taken)[i];
    EXPECT_NEAR(plate.exposure_s, i < ExposureBracket::kPlates ? 2e-3 : 5e-4, 1e-5);
    EXPECT_EQ(plate.frames_s, kRest_s);
    Image<Rgb8> expected;
    rig_.draw(plate.exposure_s, expected);
    EXPECT_EQ(plate.plate.at(60, 30), expected.at(60, 30)) << "exposed as it says: " << i;
  }
  expect_at_rest();
  capture::Capture frame;
  HostTime from{};
  ASSERT_TRUE(rig_.next({}, frame, from));
  EXPECT_EQ(frame.plate.at(60, 30), rig_.plate().at(60, 30)) << "also by the picture";
}

/// Pictures arrive rarely, as on a loaded machine.
TEST_F(Bracket, PicturesThatComeSeldomAreWaitedFor) {
  rig_.period = 1200ms;
  const auto taken = take();
  ASSERT_TRUE(taken) << taken.error().context;
  EXPECT_EQ(taken->size(), 2U * ExposureBracket::kPlates);
  expect_at_rest();
}

TEST_F(Bracket, ADarkViewIsExposedLonger) {
  rig_.lamp = 0.5, rig_.surface = 1e-3;
  const auto taken = take();
  ASSERT_TRUE(taken) << taken.error().context;
  ASSERT_EQ(taken->size(), std::size_t{ExposureBracket::kPlates});
  EXPECT_NEAR(taken->front().exposure_s, 3.2e-2, 1e-5);
  expect_at_rest();
}

TEST_F(Bracket, NoFrameIsLostToALongExposure) {
  rig_.lamp = 0.5, rig_.surface = 1e-3;
  auto bracket = ExposureBracket::create(camera_, 20ms);
  ASSERT_TRUE(bracket);
  const auto taken = bracket->take(rig_, rig_.plate(), rig_.stop, clock_);
  ASSERT_TRUE(taken);
  for (const capture::BracketPlate& plate : *taken) EXPECT_LE(plate.exposure_s, 0.018 + 1e-9);
}

TEST_F(Bracket, AViewThatShowsAllIsLeftAlone) {
  rig_.lamp = 0.5;
  const auto taken = take();
  ASSERT_TRUE(taken);
  EXPECT_TRUE(taken->empty());
  EXPECT_EQ(rig_.frames, 0);
  EXPECT_EQ(camera_.sets.size(), 1U);
}

TEST_F(Bracket, ACameraThatDoesNotFollowIsNamedAndNotAskedAgain) {
  for (const int fault : {0, 1, 2}) {
    ControlledCamera camera;
    camera.deaf = fault == 0, camera.refuses = fault == 1, camera.lies = fault == 2;
    ExposedRig rig(clock_, camera);
    auto bracket = ExposureBracket::create(camera, 40ms);
    ASSERT_TRUE(bracket);
    const auto taken = bracket->take(rig, rig.plate(), rig.stop, clock_);
    ASSERT_TRUE(taken) << taken.error().context;
    EXPECT_TRUE(taken->empty());
    EXPECT_EQ(camera.sets.back(), kRest_s);
    const std::size_t asked = camera.sets.size();
    ASSERT_TRUE(bracket->take(rig, rig.plate(), rig.stop, clock_));
    EXPECT_EQ(camera.sets.size(), asked);
  }
}

TEST_F(Bracket, IsPutBackWhenItIsStoppedAndAfterAnError) {
  rig_.stops_at = 6;
  ASSERT_TRUE(take());
  expect_at_rest();
  EXPECT_GT(camera_.sets.size(), 2U);
  rig_.stop = false, rig_.fails_at = rig_.frames + 6;
  const auto failed = take();
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kDevice);
  expect_at_rest();
}

TEST_F(Bracket, APictureThatDoesNotComeBackIsAnError) {
  auto bracket = ExposureBracket::create(camera_, 40ms);
  ASSERT_TRUE(bracket);
  const Image<Rgb8> before = rig_.plate();
  const auto fails = [&] {
    Image<Rgb8> darker;
    rig_.draw(0.5 * kRest_s, darker);  // the light has changed meanwhile
    return bracket->take(rig_, darker, rig_.stop, clock_);
  }();
  ASSERT_FALSE(fails);
  EXPECT_EQ(fails.error().code, ErrorCode::kTimeout);
  EXPECT_NE(fails.error().context.find("not as bright"), std::string::npos);
}

TEST_F(Bracket, ACameraWithoutTheControlIsSaid) {
  camera_.info_.controls.clear();
  const auto bracket = ExposureBracket::create(camera_, 40ms);
  ASSERT_FALSE(bracket);
  EXPECT_EQ(bracket.error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace mixrig::live

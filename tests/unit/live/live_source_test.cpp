// SPDX-License-Identifier: Apache-2.0
// Live devices as a source of frames: a recording that plays, cameras that send nothing, a stop.
#include "host/capture/live/session/live_source.h"

#include <thread>

#include <gtest/gtest.h>

#include "hal/fake/fake_camera.h"
#include "host/capture/live/session/live_capture.h"
#include "tests/support/made_playable.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"

namespace mixrig::live {
namespace {

using namespace std::chrono_literals;

class LiveSourceTest : public ::testing::Test {
 protected:
  Result<std::unique_ptr<capture::CaptureSource>> open(int frames) {
    RigConfig config;
    config.name = "played";
    config.cameras.emplace_back();
    config.cameras[0].name = "color";
    config.cameras[0].uri = "take:made/color";
    config.depth.emplace();
    config.depth->name = "depth";
    config.depth->uri = "take:made/depth";
    std::vector<Recording> recordings;
    recordings.push_back({"take:made", std::unique_ptr<capture::CaptureSource>(
                                           std::make_unique<test::MadeRecording>(frames))});
    DeviceOpener opener(clock_, std::move(recordings));
    MIXRIG_ASSIGN(Devices devices, open_devices(config, std::move(opener)));
    return make_live_source(std::move(config), std::move(devices), stop_, clock_, WhenLost::kEnd,
                            settings_);
  }
  std::shared_ptr<CameraSettings> settings_;
  test::SteppedClock clock_;
  std::atomic<bool> stop_ = false;
};

TEST_F(LiveSourceTest, GivesEveryMomentInOrderAndEndsWithTheRecording) {
  auto source = open(20);
  ASSERT_TRUE(source) << to_line(source.error());
  EXPECT_EQ((*source)->info().frames, capture::kEndless);
  EXPECT_EQ((*source)->info().target.pinhole.fx_px, 20) << "calibration of the recording";
  capture::Capture frame;
  for (int number = 1; number <= 20; ++number, clock_.advance(40ms)) {
    const auto there = (*source)->read(number, frame);
    ASSERT_TRUE(there) << to_line(there.error());
    ASSERT_TRUE(*there) << number;
    EXPECT_EQ(frame.number, number);
    EXPECT_EQ(frame.status_of(capture::Stream::kDepth), capture::StreamStatus::kFresh);
    EXPECT_EQ(frame.status_of(capture::Stream::kFisheye), capture::StreamStatus::kAbsent);
    EXPECT_EQ(frame.pose_origin, capture::PoseOrigin::kRecorded);
    EXPECT_EQ(frame.plate.at(3, 4), (Rgb8{static_cast<std::uint8_t>(number), 100, 200}));
    EXPECT_NEAR(frame.depth_m.at(3, 4), 0.01 * number, 1e-6);
    EXPECT_NEAR(frame.time_s, 0.04 * (number - 1), 1e-9);
    EXPECT_EQ(frame.world_from_target.translation_m.z(), 3);
  }
  const auto over = (*source)->read(21, frame);
  ASSERT_TRUE(over);
  EXPECT_FALSE(*over);
  const capture::SourceReport report = *(*source)->report();
  EXPECT_EQ(report.sets, 20U);
  EXPECT_EQ(report.dropped_sets, 0U);
  EXPECT_EQ(report.left_out, 0U);
}

TEST_F(LiveSourceTest, AConsumerThatIsLateLosesFramesAndTheReportSaysHowMany) {
  auto source = open(20);
  ASSERT_TRUE(source);
  capture::Capture frame;
  ASSERT_TRUE(*(*source)->read(1, frame));
  for (int sets = 2; sets <= 20; ++sets) {
    clock_.advance(40ms);
    ASSERT_TRUE(test::comes_true(
        [&] { return (*source)->report()->sets == static_cast<std::uint64_t>(sets); }));
  }
  int read = 1;
  for (;;) {
    const auto there = (*source)->read(read + 1, frame);
    ASSERT_TRUE(there);
    if (!*there) break;
    ++read;
  }
  EXPECT_EQ(frame.plate.at(0, 0).r, 20) << "the newest are kept";
  const capture::SourceReport report = *(*source)->report();
  EXPECT_EQ(report.sets, 20U);
  EXPECT_EQ(report.dropped_sets + static_cast<std::uint64_t>(read), 20U);
}

TEST_F(LiveSourceTest, ItsCamerasCanBeSetWhileItRuns) {
  settings_ = std::make_shared<CameraSettings>();
  auto source = open(1000);
  ASSERT_TRUE(source);
  EXPECT_TRUE(settings_->cameras().empty()) << "nothing runs yet";
  capture::Capture frame;
  ASSERT_TRUE(*(*source)->read(1, frame));
  ASSERT_EQ(settings_->cameras().size(), 1U);
  EXPECT_EQ(settings_->cameras()[0].name, "color");
  source->reset();
  EXPECT_TRUE(settings_->cameras().empty());
}

TEST_F(LiveSourceTest, StopEndsIt) {
  auto source = open(1000);
  ASSERT_TRUE(source);
  capture::Capture frame;
  ASSERT_TRUE(*(*source)->read(1, frame));
  stop_ = true;
  EXPECT_FALSE(*(*source)->read(2, frame));
}

TEST_F(LiveSourceTest, CamerasThatStaySilentAreAnErrorAfterFiveSeconds) {
  const auto camera = [this](device::PixelFormat format) {
    return std::make_unique<fake::FakeCamera>(
        clock_, device::CameraInfo{.uri = "fake:", .size = {16, 12}, .format = format});
  };
  Devices devices;
  devices.cameras.push_back(camera(device::PixelFormat::kRgb8));
  devices.depth = device::as_depth_camera(camera(device::PixelFormat::kDepth16), {});
  RigConfig config;
  config.cameras.emplace_back();
  config.depth.emplace();
  auto source = make_live_source(std::move(config), std::move(devices), stop_, clock_);
  ASSERT_TRUE(source);
  std::atomic<bool> done = false;
  std::thread time([&] {
    while (!done) clock_.advance(1ms);
  });
  capture::Capture frame;
  const auto there = (*source)->read(1, frame);
  done = true;
  time.join();
  ASSERT_FALSE(there);
  EXPECT_EQ(there.error().code, ErrorCode::kDevice);
  EXPECT_NE(there.error().context.find("mixrig diag"), std::string::npos);
}

/// A source of two cameras that deliver while they are plugged in.
class LiveSourceLoss : public LiveSourceTest {
 protected:
  void SetUp() override { open_cameras(WhenLost::kEnd); }
  void open_cameras(WhenLost when_lost) {
    Devices devices;
    devices.cameras.push_back(camera(device::PixelFormat::kRgb8, color_));
    devices.depth = device::as_depth_camera(camera(device::PixelFormat::kDepth16, depth_), {});
    RigConfig config;
    config.cameras.emplace_back();
    config.cameras[0].name = "color", config.cameras[0].uri = "fake:color";
    config.depth.emplace();
    config.depth->name = "depth", config.depth->uri = "fake:depth";
    auto source = make_live_source(std::move(config), std::move(devices), stop_, clock_, when_lost);
    ASSERT_TRUE(source) << to_line(source.error());
    source_ = *std::move(source);
  }
  /// Result of read() while time passes.
  Result<bool> read_while_they_deliver() {
    std::atomic<bool> done = false;
    std::thread time([&] {
      while (!done) {
        clock_.advance(40ms);
        color_->emit(), depth_->emit();
        test::comes_true([&] { return done || source_->report()->waiting_events == 0; });
      }
    });
    auto there = source_->read(1, frame_);
    done = true;
    time.join();
    return there;
  }
  capture::Capture frame_;
  fake::FakeCamera *color_ = nullptr, *depth_ = nullptr;
  std::unique_ptr<capture::CaptureSource> source_;

 private:
  std::unique_ptr<fake::FakeCamera> camera(device::PixelFormat format, fake::FakeCamera*& handle) {
    auto made = std::make_unique<fake::FakeCamera>(
        clock_,
        device::CameraInfo{.uri = "fake:",
                           .size = {16, 12},
                           .format = format,
                           .rate_hz = 25,
                           .stamp_clock = device::StampClock::kHost},
        256);
    handle = made.get();
    return made;
  }
};

TEST_F(LiveSourceLoss, OfTheDepthCameraIsNamedAfterFiveSecondsThoughColourGoesOn) {
  const auto first = read_while_they_deliver();
  ASSERT_TRUE(first && *first);
  depth_->unplug();
  const HostTime from = clock_.now();
  auto there = read_while_they_deliver();
  while (there && *there) there = read_while_they_deliver();  // sets from before
  ASSERT_FALSE(there) << "it ended as a recording does";
  EXPECT_EQ(there.error().code, ErrorCode::kDevice);
  EXPECT_NE(there.error().context.find("camera 'depth' (fake:depth) is lost: check its cable"),
            std::string::npos)
      << there.error().context;
  EXPECT_GE(clock_.now() - from, 5s);
  EXPECT_GT((*source_->report()).left_out, 0U);
}

TEST_F(LiveSourceLoss, OfTheColourCameraIsNamedAndItsReturnGoesOn) {
  const auto first = read_while_they_deliver();
  ASSERT_TRUE(first && *first);
  color_->unplug();
  auto there = read_while_they_deliver();
  while (there && *there) there = read_while_they_deliver();
  ASSERT_FALSE(there);
  EXPECT_NE(there.error().context.find("camera 'color' (fake:color) is lost"), std::string::npos)
      << there.error().context;
  color_->replug();
  there = read_while_they_deliver();
  EXPECT_TRUE(there && *there) << (there ? "ended" : there.error().context);
}

/// The same, where a lost camera does not end the source.
class LiveSourceGoesOn : public LiveSourceLoss {
 protected:
  void SetUp() override { open_cameras(WhenLost::kGoOn); }
  capture::StreamStatus depth_status() const { return frame_.status_of(capture::Stream::kDepth); }
  /// Reads until `condition` holds for a capture; false where the source ends or fails before.
  template <typename Condition>
  bool read_until(Condition condition) {
    for (int i = 0; i < 500; ++i) {
      const auto there = read_while_they_deliver();
      if (!there || !*there) return false;
      if (condition()) return true;
    }
    return false;
  }
  /// The same, frame by frame, so that no set is dropped; after the first read.
  template <typename Condition>
  bool step_until(Condition condition) {
    for (int i = 0; i < 500; ++i) {
      clock_.advance(40ms);
      color_->emit(), depth_->emit();
      if (!test::comes_true([&] { return source_->report()->waiting_events == 0; })) return false;
      while (source_->report()->waiting_sets > 0) {
        const auto there = source_->read(1, frame_);
        if (!there || !*there) return false;
        if (condition()) return true;
      }
    }
    return false;
  }
};

TEST_F(LiveSourceGoesOn, WithoutDepthWhichIsHeldForAMomentAndThenMissing) {
  using capture::StreamStatus;
  ASSERT_TRUE(read_until([&] { return depth_status() == StreamStatus::kFresh; }));
  depth_->unplug();
  HostTime last_fresh = frame_.mid_exposure;
  ASSERT_TRUE(step_until([&] {
    if (depth_status() == StreamStatus::kFresh) last_fresh = frame_.mid_exposure;
    return depth_status() == StreamStatus::kRepeated;
  }));
  EXPECT_EQ(frame_.depth_m.size(), (Size{16, 12}));
  EXPECT_LE(frame_.mid_exposure - last_fresh, kDepthHold);
  ASSERT_TRUE(step_until([&] { return depth_status() == StreamStatus::kMissing; }));
  EXPECT_GT(frame_.mid_exposure - last_fresh, kDepthHold);
  EXPECT_TRUE(frame_.depth_m.empty());
  EXPECT_TRUE(frame_.amplitude.empty());
  EXPECT_EQ(frame_.status_of(capture::Stream::kPlate), StreamStatus::kFresh);
  const HostTime from = clock_.now();
  ASSERT_TRUE(step_until([&] { return clock_.now() - from > 6s; }))
      << "five seconds end it no more";
  EXPECT_EQ(depth_status(), StreamStatus::kMissing);
  depth_->replug();
  ASSERT_TRUE(step_until([&] { return depth_status() == StreamStatus::kFresh; }));
  EXPECT_EQ(frame_.depth_m.size(), (Size{16, 12}));
  const capture::SourceReport report = *source_->report();
  EXPECT_GT(report.without_depth, 100U);
  EXPECT_GE(report.held_depth, 1U);
  EXPECT_LE(report.held_depth, 3U);
}

TEST_F(LiveSourceGoesOn, WhenColourComesBackHoweverLongThatTakes) {
  ASSERT_TRUE(read_until([] { return true; }));
  color_->unplug();
  std::atomic<bool> back = false;
  std::thread plug([&] {
    const HostTime from = clock_.now();
    test::comes_true([&] { return clock_.now() - from > 20s; });
    back = true;
    color_->replug();
  });
  EXPECT_TRUE(read_until([&] { return back.load(); }));
  plug.join();
  EXPECT_GT(source_->report()->longest_gap_s, 10);
}

TEST_F(LiveSourceGoesOn, StopEndsTheWaitForColour) {
  ASSERT_TRUE(read_until([] { return true; }));
  color_->unplug();
  std::thread end([&] {
    const HostTime from = clock_.now();
    test::comes_true([&] { return clock_.now() - from > 7s; });
    stop_ = true;
  });
  auto there = read_while_they_deliver();
  while (there && *there) there = read_while_they_deliver();
  end.join();
  ASSERT_TRUE(there) << there.error().context;
  EXPECT_FALSE(*there);
}

TEST_F(LiveSourceGoesOn, ADepthCameraThatNeverCameIsStillAnError) {
  depth_->unplug();
  const auto there = read_while_they_deliver();
  ASSERT_FALSE(there);
  EXPECT_EQ(there.error().code, ErrorCode::kDevice);
}

TEST(LiveSourceOpen, NeedsACameraAndADepthCamera) {
  ManualClock clock;
  const std::atomic<bool> stop = false;
  const auto open = [&](bool camera, bool depth) {
    const auto fake = [&](device::PixelFormat format) {
      return std::make_unique<fake::FakeCamera>(
          clock, device::CameraInfo{.uri = "fake:", .size = {16, 12}, .format = format});
    };
    Devices devices;
    RigConfig config;
    config.cameras.emplace_back();
    config.depth.emplace();
    if (camera) devices.cameras.push_back(fake(device::PixelFormat::kRgb8));
    if (depth) devices.depth = device::as_depth_camera(fake(device::PixelFormat::kDepth16), {});
    const auto source = make_live_source(std::move(config), std::move(devices), stop, clock);
    if (source) return std::string();
    EXPECT_EQ(source.error().code, ErrorCode::kUsage);
    return source.error().context;
  };
  EXPECT_EQ(open(true, true), "");
  EXPECT_NE(open(true, false).find("[depth]"), std::string::npos);
  EXPECT_NE(open(false, true).find("[[camera]]"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::live

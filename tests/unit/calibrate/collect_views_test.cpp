// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate views on a scripted source: a camera that is lost in the middle, Ctrl-C, a depth
// camera without amplitude. What was taken before must be there, whole.
#include "host/tools/calibrate/collect_views.h"

#include <functional>

#include <gtest/gtest.h>

#include "host/calibrate/rig/view_set.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/calibrate/drawn_capture.h"

namespace mixrig::test {
namespace {

using namespace std::chrono_literals;
using capture::Capture;
using device::DeviceState;

constexpr int kRestFrames = 6;  ///< at each place; five make a view

/// A board that rests at one position after the other before a target and a depth camera; the
/// fisheye shows nothing.
class HeldBoard final : public capture::CaptureSource {
 public:
  HeldBoard() {
    info_.frames = capture::kEndless;
    for (const char* name : {"target", "fisheye", "depth"}) {
      capture::StreamReport& stream = report_.streams.emplace_back();
      stream.name = name, stream.uri = std::string("v4l2:") + name;
      stream.health.state = DeviceState::kStreaming;
    }
  }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, Capture& capture) override {
    const int place = (number - 1) / kRestFrames;
    capture = frame(number, facing(0.05 * (place % 4) - 0.08, 0.04 * (place % 3) - 0.04, 0.7));
    capture.mid_exposure += late;
    if (!amplitude) capture.amplitude = {};
    return on_read ? on_read(number) : true;
  }
  Result<void> read_truth(int, capture::Truth&) override {
    return Error{ErrorCode::kData, "no truth"};
  }
  std::optional<capture::SourceReport> report() const override { return report_; }
  void set_state(std::size_t stream, DeviceState state) {
    report_.streams[stream].health.state = state;
  }

  std::function<Result<bool>(int number)> on_read;
  Duration late{};  ///< of the captures from now on
  bool amplitude = true;

 private:
  capture::SourceInfo info_ = source_info();
  capture::SourceReport report_;
};

class CollectViews : public ::testing::Test {
 protected:
  CollectViews() {
    arguments_.out = folder_.path() / "out";
    arguments_.settings.board = kDrawnBoard;
    arguments_.settings.frames = 5, arguments_.settings.still_time = 150ms;
  }
  auto collect() { return tools::collect_views(source_, arguments_, stop_); }
  /// Expects that each picture of each view can be read, and that no other file remains.
  void expect_whole(int views) const {
    const auto set = calibration::read_view_set(arguments_.out);
    ASSERT_TRUE(set) << set.error().context;
    EXPECT_EQ(set->views, views);
    EXPECT_EQ(set->cameras.size(), 2U);
    for (const auto& camera : set->cameras)
      for (int view = 1; view <= views; ++view) {
        const auto read = calibration::load_view(*set, camera, view);
        EXPECT_TRUE(read) << read.error().context;
      }
    EXPECT_TRUE(std::filesystem::exists(arguments_.out / "coverage.png"));
    expect_entries(1);
  }
  void expect_entries(int count) const {
    const std::filesystem::directory_iterator there(folder_.path());
    EXPECT_EQ(std::distance(begin(there), end(there)), count) << "half a folder was left";
  }
  static void expect_error(const Result<nlohmann::json>& result, const std::string& text) {
    ASSERT_FALSE(result) << result->dump();
    EXPECT_EQ(result.error().code, ErrorCode::kDevice);
    EXPECT_NE(result.error().context.find(text), std::string::npos) << result.error().context;
    EXPECT_EQ(result.error().context.find('\n'), std::string::npos) << "one line";
  }

  TemporaryFolder folder_;
  HeldBoard source_;
  tools::CollectArguments arguments_;
  std::atomic<bool> stop_ = false;
};

TEST_F(CollectViews, ALostCameraEndsThemWithWhatThereIs) {
  source_.on_read = [this](int number) -> Result<bool> {
    if (number < 2 * kRestFrames + 3) return true;
    return Error{ErrorCode::kDevice, "camera 'target' (v4l2:target) is lost: check its cable"};
  };
  expect_error(collect(),
               "camera 'target' (v4l2:target) is lost: check its cable (the 2 views so "
               "far are in '" +
                   arguments_.out.string() + "')");
  expect_whole(2);
}

TEST_F(CollectViews, CamerasThatFailedAreNoEndOfARecording) {
  source_.on_read = [this](int number) -> Result<bool> {
    if (number < 2 * kRestFrames + 3) return true;
    source_.set_state(2, DeviceState::kFailed);
    return false;
  };
  expect_error(collect(), "camera 'depth' (v4l2:depth) has failed");
  expect_whole(2);
}

TEST_F(CollectViews, AFisheyeThatComesBackIsAwaitedForFiveSeconds) {
  int lost_twice = 0;
  source_.on_read = [&](int number) -> Result<bool> {
    const bool first = number == kRestFrames + 1, second = number == 3 * kRestFrames + 1;
    if (first || second) source_.set_state(1, DeviceState::kLost), ++lost_twice;
    if (number == 2 * kRestFrames) source_.set_state(1, DeviceState::kStreaming);
    if (second) source_.late = 4800ms;  // of the next frame
    return true;
  };
  expect_error(collect(), "camera 'fisheye' (v4l2:fisheye) is lost: check its cable and power");
  EXPECT_EQ(lost_twice, 2);
  expect_whole(4);  // the other cameras go on
}

TEST_F(CollectViews, ACameraThatIsLostBeforeTheFirstOneLeavesNothing) {
  source_.on_read = [](int number) -> Result<bool> {
    if (number < 3) return true;
    return Error{ErrorCode::kDevice, "camera 'target' is lost"};
  };
  expect_error(collect(), "camera 'target' is lost");
  expect_entries(0);
}

TEST_F(CollectViews, AStopKeepsWhatThereIsAndIsNoError) {
  source_.on_read = [this](int number) -> Result<bool> {
    stop_ = number >= 2 * kRestFrames + 3;
    return !stop_;
  };
  const auto report = collect();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->at("ended"), "stopped");
  EXPECT_EQ(report->at("views"), 2);
  expect_whole(2);
}

TEST_F(CollectViews, AStopBeforeTheFirstOneIsAnErrorAndLeavesNothing) {
  source_.on_read = [this](int number) -> Result<bool> {
    stop_ = number >= 3;
    return !stop_;
  };
  const auto report = collect();
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kData);
  expect_entries(0);
}

TEST_F(CollectViews, ADepthCameraWithoutAmplitudeIsNamedInOneLine) {
  source_.amplitude = false;
  source_.on_read = [](int number) -> Result<bool> { return number <= kRestFrames; };
  ::testing::internal::CaptureStderr();
  const auto report = collect();
  const std::string said = ::testing::internal::GetCapturedStderr();
  ASSERT_TRUE(report) << report.error().context;
  const auto at = said.find("the depth camera gives no amplitude");
  EXPECT_NE(at, std::string::npos) << said;
  EXPECT_EQ(said.find("no amplitude", at + 30), std::string::npos) << "said once: " << said;
  const auto set = calibration::read_view_set(arguments_.out);
  ASSERT_TRUE(set) << set.error().context;
  EXPECT_EQ(set->cameras.size(), 1U);
}

}  // namespace
}  // namespace mixrig::test

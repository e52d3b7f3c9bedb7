// SPDX-License-Identifier: Apache-2.0
// The OpenNI2 driver against Debian's library: a camera that a driver module of the tests plays,
// and recordings of it that the library's own recorder makes and its own player reads.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "extras/openni2/openni2_camera.h"
#include "tests/support/openni2/scripted_camera.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/hal_device/camera_contract.h"
#include "tests/unit/hal_device/depth_camera_contract.h"

namespace mixrig::test {
namespace {

constexpr int kWidth = 64, kHeight = 48;

/// Frame n: every step differs from its neighbours and from the frame before; some are unknown.
std::vector<std::uint16_t> depth_of(int n) {
  std::vector<std::uint16_t> steps;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      steps.push_back(
          static_cast<std::uint16_t>((x + y + n) % 17 == 0 ? 0 : 500 + 97 * x + 31 * y + 7 * n));
  return steps;
}
std::vector<std::uint8_t> color_of(int n) {
  std::vector<std::uint8_t> rgb;
  for (int i = 0; i < 3 * kWidth * kHeight; ++i)
    rgb.push_back(static_cast<std::uint8_t>(5 * i + n));
  return rgb;
}

ScriptedModule make_module(int unit_um = 1000, float fov_rad = 1.0F) {
  return ScriptedModule(MIXRIG_OPENNI2_MODULE,
                        {kWidth, kHeight, unit_um, fov_rad, kWidth, kHeight, 33333});
}

/// Frames of one camera as they came.
struct Kept {
  std::vector<std::uint64_t> counters;
  std::vector<DeviceTime> stamps;
  std::vector<std::uint32_t> flags;
  std::vector<std::vector<std::uint8_t>> bytes;
};
class Keeper {
 public:
  device::FrameSink sink() {
    return [this](const device::FramePtr& frame) {
      const std::lock_guard lock(mutex_);
      kept_.counters.push_back(frame->sequence);
      kept_.stamps.push_back(frame->device_time);
      kept_.flags.push_back(frame->flags);
      kept_.bytes.emplace_back(frame->bytes.begin(), frame->bytes.end());
    };
  }
  Kept kept() {
    const std::lock_guard lock(mutex_);
    return kept_;
  }

 private:
  std::mutex mutex_;
  Kept kept_;
};

std::vector<std::uint16_t> words(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::uint16_t> out(bytes.size() / 2);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<std::uint16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8);
  return out;
}

/// A recording of `count` frames from frame 1 on, in the folder.
std::string record(ScriptedModule& module, const TemporaryFolder& folder, int count) {
  const std::string file = folder.path() / "take.oni";
  ScriptedRecording recording(file, module, std::vector<std::uint16_t>(kWidth * kHeight),
                              std::vector<std::uint8_t>(3 * kWidth * kHeight));
  for (int n = 1; n <= count; ++n) module.expose(recording.next(), depth_of(n), color_of(n));
  return file;
}
/// Pictures before frame 1: those of zeros.
std::size_t leading(const std::vector<std::vector<std::uint8_t>>& pictures) {
  const auto zeros = [](const std::vector<std::uint8_t>& picture) {
    return std::all_of(picture.begin(), picture.end(), [](std::uint8_t byte) { return byte == 0; });
  };
  return static_cast<std::size_t>(std::find_if_not(pictures.begin(), pictures.end(), zeros) -
                                  pictures.begin());
}

struct Both {
  std::unique_ptr<device::Camera> color;
  std::unique_ptr<device::DepthCamera> depth;
};
Both open_both(const std::string& uri, Clock& clock) {
  auto shared = device::open_openni2(uri, clock);
  EXPECT_TRUE(shared) << to_line(shared.error());
  if (!shared) return {};
  auto color = device::openni2_color(*shared, {});
  auto depth = device::openni2_depth(*shared, {});
  EXPECT_TRUE(color) << to_line(color.error());
  EXPECT_TRUE(depth) << to_line(depth.error());
  if (!color || !depth) return {};
  return {*std::move(color), *std::move(depth)};
}

/// Shows frames until the camera has delivered so many more, or stops.
template <typename CameraType>
std::function<void(int)> exposer(ScriptedModule module, CameraType* camera) {
  return [module, camera, n = 0](int count) mutable {
    const auto wanted = camera->health().frames + static_cast<std::uint64_t>(count);
    const auto before = [&] { return camera->health().frames; };
    while (before() < wanted) {
      const auto now = before();
      ++n;
      module.expose(n, depth_of(n), color_of(n));
      if (camera->health().state != device::DeviceState::kStreaming) return;
      EXPECT_TRUE(comes_true([&] { return before() > now; }));
    }
  };
}

SystemClock& system_clock() {
  static SystemClock clock;
  return clock;
}

CameraUnderTest make_color() {
  ScriptedModule module = make_module();
  auto shared = device::open_openni2("scripted", system_clock());
  if (!shared) return {};
  auto camera = device::openni2_color(*shared, {});
  if (!camera) return {};
  auto* raw = camera->get();
  return {*std::move(camera), exposer(module, raw)};
}
INSTANTIATE_TEST_SUITE_P(OpenNi2, CameraContract,
                         ::testing::Values(CameraMaker{"openni2", make_color}),
                         [](const auto& maker) { return maker.param.name; });

DepthCameraUnderTest make_depth() {
  ScriptedModule module = make_module();
  auto shared = device::open_openni2("any", system_clock());
  if (!shared) return {};
  auto camera = device::openni2_depth(*shared, {});
  if (!camera) return {};
  auto* raw = camera->get();
  return {*std::move(camera), exposer(module, raw)};
}
INSTANTIATE_TEST_SUITE_P(OpenNi2, DepthCameraContract,
                         ::testing::Values(DepthCameraMaker{"openni2", make_depth}),
                         [](const auto& maker) { return maker.param.name; });

TEST(OpenNi2Recording, OfTheLibrarysOwnRecorderGivesTheSameDepthAndColour) {
  const TemporaryFolder folder;
  ScriptedModule module = make_module();
  constexpr int kFrames = 12;
  const std::string file = record(module, folder, kFrames);
  SystemClock clock;
  Both both = open_both(file, clock);
  ASSERT_TRUE(both.color && both.depth);
  Keeper color, depth;
  ASSERT_TRUE(both.color->start(color.sink()));
  ASSERT_TRUE(both.depth->start(depth.sink()));
  const auto over = [](const device::StreamHealth& health) {
    return health.state == device::DeviceState::kStopped;
  };
  ASSERT_TRUE(comes_true([&] { return over(both.color->health()) && over(both.depth->health()); }));
  const Kept steps = depth.kept(), rgb = color.kept();
  const std::size_t first_depth = leading(steps.bytes), first_color = leading(rgb.bytes);
  ASSERT_EQ(steps.bytes.size(), first_depth + kFrames);
  ASSERT_EQ(rgb.bytes.size(), first_color + kFrames);
  for (int n = 1; n <= kFrames; ++n) {
    const std::size_t d = first_depth + static_cast<std::size_t>(n) - 1;
    const std::size_t c = first_color + static_cast<std::size_t>(n) - 1;
    EXPECT_EQ(words(steps.bytes[d]), depth_of(n)) << n;
    EXPECT_EQ(rgb.bytes[c], color_of(n)) << n;
    EXPECT_EQ(steps.flags[d] | rgb.flags[c], device::kFrameOk);
    EXPECT_EQ(steps.stamps[d] - steps.stamps[0], std::chrono::microseconds(33333) * d);
    EXPECT_EQ(rgb.stamps[c] - rgb.stamps[0], std::chrono::microseconds(33333) * c);
  }
  EXPECT_EQ(both.depth->health().lost, 0U);
}

TEST(OpenNi2Recording, IsPlayedAgainFromItsFirstFrameWhenItIsStartedAgain) {
  const TemporaryFolder folder;
  ScriptedModule module = make_module();
  const std::string file = record(module, folder, 4);
  SystemClock clock;
  auto shared = device::open_openni2(file, clock);
  ASSERT_TRUE(shared) << to_line(shared.error());
  auto camera = device::openni2_depth(*shared, {});
  ASSERT_TRUE(camera);
  Keeper keeper;
  for (std::size_t times = 1; times <= 2; ++times) {
    ASSERT_TRUE((*camera)->start(keeper.sink()));
    ASSERT_TRUE(
        comes_true([&] { return (*camera)->health().state == device::DeviceState::kStopped; }));
    (*camera)->stop();
    const Kept kept = keeper.kept();
    const std::size_t before = leading(kept.bytes);
    ASSERT_EQ(kept.bytes.size(), (before + 4) * times);
    EXPECT_EQ(words(kept.bytes[(before + 4) * times - 4]), depth_of(1));
    EXPECT_EQ(words(kept.bytes.back()), depth_of(4));
  }
}

TEST(OpenNi2Depth, UnitAndIntrinsicsAreThoseOfTheLibrarysOwnConversion) {
  ScriptedModule module = make_module(100, 1.02F);
  SystemClock clock;
  auto shared = device::open_openni2("scripted", clock);
  ASSERT_TRUE(shared) << to_line(shared.error());
  auto camera = device::openni2_depth(*shared, {});
  ASSERT_TRUE(camera) << to_line(camera.error());
  EXPECT_FALSE(module.registered());
  const device::DepthInfo info = (*camera)->depth();
  EXPECT_DOUBLE_EQ(info.metres_per_step, 0.0001);
  ASSERT_TRUE(info.intrinsics);
  // A second stream of the same sensor, for the library's conversion of depth to points.
  OniDeviceHandle device = nullptr;
  OniStreamHandle stream = nullptr;
  ASSERT_EQ(oniDeviceOpen("scripted", &device), ONI_STATUS_OK);
  ASSERT_EQ(oniDeviceCreateStream(device, ONI_SENSOR_DEPTH, &stream), ONI_STATUS_OK);
  for (const float u : {0.0F, 10.0F, 63.0F})
    for (const float v : {0.0F, 24.0F, 47.0F}) {
      float x = 0, y = 0, z = 0;
      ASSERT_EQ(oniCoordinateConverterDepthToWorld(stream, u, v, 2000, &x, &y, &z), ONI_STATUS_OK);
      const auto& k = *info.intrinsics;
      EXPECT_NEAR((u - k.principal_x_px) / k.focal_px * 2000, x, 0.01);
      EXPECT_NEAR((k.principal_y_px - v) / k.focal_px * 2000, y, 0.01);  // the library's y is up
    }
  oniStreamDestroy(stream);
  oniDeviceClose(device);
}

TEST(OpenNi2Depth, WithoutAFieldOfViewThereAreNoIntrinsics) {
  (void)make_module(1000, 0.0F);
  SystemClock clock;
  auto shared = device::open_openni2("scripted", clock);
  ASSERT_TRUE(shared);
  auto camera = device::openni2_depth(*shared, {});
  ASSERT_TRUE(camera);
  EXPECT_FALSE((*camera)->depth().intrinsics);
  EXPECT_DOUBLE_EQ((*camera)->depth().metres_per_step, 0.001);
}

TEST(OpenNi2Live, MirroringIsTurnedOffAndALostFrameIsCounted) {
  ScriptedModule module = make_module();
  SystemClock clock;
  Both both = open_both("scripted", clock);
  ASSERT_TRUE(both.color && both.depth);
  Keeper color, depth;
  ASSERT_TRUE(both.depth->start(depth.sink()));
  ASSERT_TRUE(both.color->start(color.sink()));
  for (const int n : {1, 2, 5}) {
    const auto before = both.color->health().frames + both.depth->health().frames;
    module.expose(n, depth_of(n), color_of(n));
    ASSERT_TRUE(comes_true([&] {
      return both.color->health().frames + both.depth->health().frames == before + 2;
    })) << n;
  }
  both.color->stop();
  both.depth->stop();
  EXPECT_EQ(words(depth.kept().bytes.at(2)), depth_of(5));
  EXPECT_EQ(color.kept().bytes.at(1), color_of(2));
  EXPECT_EQ(both.depth->health().lost, 2U);
  EXPECT_EQ(depth.kept().flags.at(2), device::kFrameAfterGap);
}

TEST(OpenNi2Live, ACameraUnpluggedAndBackDeliversAgain) {
  ScriptedModule module = make_module();
  SystemClock clock;
  Both both = open_both("any", clock);
  ASSERT_TRUE(both.color && both.depth);
  Keeper color, depth;
  ASSERT_TRUE(both.color->start(color.sink()));
  ASSERT_TRUE(both.depth->start(depth.sink()));
  module.expose(1, depth_of(1), color_of(1));
  ASSERT_TRUE(comes_true([&] { return both.depth->health().frames == 1; }));
  module.plug(false);
  ASSERT_TRUE(comes_true([&] {
    return both.depth->health().state == device::DeviceState::kLost &&
           both.color->health().state == device::DeviceState::kLost;
  }));
  module.plug(true);
  ASSERT_TRUE(comes_true([&] { return both.depth->health().returns == 1; }));
  ASSERT_EQ(module.streams(), 2);
  module.expose(1, depth_of(9), color_of(9));
  ASSERT_TRUE(comes_true([&] { return both.depth->health().frames == 2; }));
  both.color->stop();
  both.depth->stop();
  EXPECT_EQ(words(depth.kept().bytes.at(1)), depth_of(9));
  EXPECT_EQ(depth.kept().flags.at(1), device::kFrameRestarted);
}

TEST(OpenNi2Open, WhatIsNotThereOrNoRecordingIsRefusedInOneLine) {
  const TemporaryFolder folder;
  (void)make_module();
  SystemClock clock;
  const auto missing = device::open_openni2("1d27/0601@9/9", clock);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_NE(to_line(missing.error()).find("OpenNI2 finds openni2:scripted"), std::string::npos)
      << to_line(missing.error());
  const auto other = folder.path() / "other.oni";
  std::ofstream(other) << "not a recording";
  const auto refused = device::open_openni2(other, clock);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kData);
  auto shared = device::open_openni2("scripted", clock);
  ASSERT_TRUE(shared);
  const auto mode = device::openni2_depth(*shared, {.size = {640, 480}});
  ASSERT_FALSE(mode);
  EXPECT_NE(to_line(mode.error()).find("it offers depth16 64x48 at 30 Hz"), std::string::npos)
      << to_line(mode.error());
}

}  // namespace
}  // namespace mixrig::test

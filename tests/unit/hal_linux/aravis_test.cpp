// SPDX-License-Identifier: Apache-2.0
// The aravis driver against libaravis' own GigE Vision camera on the loopback interface. Run it in
// its own network namespace: the search for cameras broadcasts.
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>

#include <arv.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "hal/linux/aravis/aravis_camera.h"
#include "hal/wire/genicam_buffer.h"
#include "tests/support/progress.h"
#include "tests/unit/hal_device/camera_contract.h"
#include "tests/unit/hal_device/depth_camera_contract.h"

namespace mixrig::test {
namespace {

using namespace std::chrono_literals;

struct Unref {
  void operator()(ArvGvFakeCamera* camera) const { g_object_unref(camera); }
};
using FakeDevice = std::unique_ptr<ArvGvFakeCamera, Unref>;

/// A file with the built-in camera description plus the features of a ToF camera.
std::string depth_description() {
  const FakeDevice plain(arv_gv_fake_camera_new("127.0.0.1", "PLAIN"));
  size_t size = 0;
  const char* xml =
      arv_fake_camera_get_genicam_xml(arv_gv_fake_camera_get_fake_camera(plain.get()), &size);
  std::string text(xml, size);
  const auto formats = text.find("<Enumeration Name=\"PixelFormat\"");
  text.insert(text.find("<EnumEntry", formats),
              "<EnumEntry Name=\"Coord3D_C16\" "
              "NameSpace=\"Standard\"><Value>17825976</Value></EnumEntry>\n");
  std::string features;
  for (const auto& [name, value] : {std::pair{"Scale", "0.25"}, std::pair{"Offset", "0.0"}})
    features += std::string("<Float Name=\"Scan3dCoordinate") + name + "\"><Value>" + value +
                "</Value></Float>\n";
  for (const auto& [name, value] :
       {std::pair{"FocalLength", "512.5"}, std::pair{"PrincipalPointU", "319.5"},
        std::pair{"PrincipalPointV", "239.5"}})
    features +=
        std::string("<Float Name=\"Scan3d") + name + "\"><Value>" + value + "</Value></Float>\n";
  text.insert(text.find("<Enumeration Name=\"PixelFormat\""), features);
  const auto path = std::filesystem::temp_directory_path() /
                    ("mixrig_tof_" + std::to_string(::getpid()) + ".xml");
  std::ofstream(path) << text;
  return path;
}

void fill_ramp(ArvBuffer* buffer, void*, guint32, guint32, ArvPixelFormat format) {
  if (format != device::pfnc::kCoord3dC16) return;
  size_t unused = 0;  // the library sets it to 0 here: the declared geometry is used
  auto* steps =
      static_cast<std::uint16_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &unused)));
  const int width = arv_buffer_get_image_width(buffer),
            height = arv_buffer_get_image_height(buffer);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) steps[y * width + x] = static_cast<std::uint16_t>(1000 + x + y);
}

class Device {
 public:
  explicit Device(const std::string& serial) : description_(depth_description()) {
    camera_.reset(arv_gv_fake_camera_new_full("127.0.0.1", serial.c_str(), description_.c_str()));
    arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(camera_.get()), fill_ramp,
                                     nullptr);
  }
  ~Device() { std::filesystem::remove(description_); }
  bool running() const { return arv_gv_fake_camera_is_running(camera_.get()); }

 private:
  std::string description_;
  FakeDevice camera_;
};

/// Counts frames and notifies the waiting test.
class Counter {
 public:
  device::FrameSink sink(device::FrameSink next = {}) {
    return [this, next](const device::FramePtr& frame) {
      if (next) next(frame);
      const std::lock_guard lock(mutex_);
      ++count_;
      changed_.notify_all();
    };
  }
  bool wait_for(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 60s, [&] { return count_ >= count; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int count_ = 0;
};

device::StreamRequest small(device::PixelFormat format) {
  return {.size = {64, 48}, .format = format, .rate_hz = 25};
}

CameraUnderTest make_aravis() {
  static SystemClock clock;
  static auto device = std::make_unique<Device>("GV01");
  if (!device->running()) return {};
  auto camera = device::open_aravis("Aravis-Fake-GV01", small(device::PixelFormat::kGray8), clock);
  if (!camera) {
    std::fprintf(stderr, "%s\n", to_line(camera.error()).c_str());
    return {};
  }
  auto* raw = camera->get();
  return {*std::move(camera), [raw](int count) {
            const auto wanted = raw->health().frames + static_cast<std::uint64_t>(count);
            const HostTime end = clock.now() + 60s;
            while (raw->health().state == device::DeviceState::kStreaming &&
                   raw->health().frames < wanted && clock.now() < end)
              clock.sleep_until(clock.now() + 5ms);
          }};
}

INSTANTIATE_TEST_SUITE_P(Aravis, CameraContract,
                         ::testing::Values(CameraMaker{"aravis", make_aravis}),
                         [](const auto& maker) { return maker.param.name; });

DepthCameraUnderTest make_aravis_depth() {
  static SystemClock clock;
  static auto device = std::make_unique<Device>("GV04");
  if (!device->running()) return {};
  auto camera =
      device::open_aravis_depth("Aravis-Fake-GV04", {.size = {64, 48}, .rate_hz = 25}, clock);
  if (!camera) return {};
  auto* raw = camera->get();
  return {*std::move(camera), [raw](int count) {
            const auto wanted = raw->health().frames + static_cast<std::uint64_t>(count);
            if (raw->health().state == device::DeviceState::kStopped) return;
            EXPECT_TRUE(comes_true([&] { return raw->health().frames >= wanted; }));
          }};
}

INSTANTIATE_TEST_SUITE_P(Aravis, DepthCameraContract,
                         ::testing::Values(DepthCameraMaker{"aravis", make_aravis_depth}),
                         [](const auto& maker) { return maker.param.name; });

TEST(AravisDepth, ScaleAndIntrinsicsAreReadFromTheCamera) {
  SystemClock clock;
  const Device device("GV02");
  ASSERT_TRUE(device.running());
  auto camera =
      device::open_aravis_depth("Aravis-Fake-GV02", {.size = {64, 48}, .rate_hz = 25}, clock);
  ASSERT_TRUE(camera) << to_line(camera.error());
  const device::DepthInfo info = (*camera)->depth();
  EXPECT_DOUBLE_EQ(info.metres_per_step, 0.00025);
  ASSERT_TRUE(info.intrinsics);
  EXPECT_DOUBLE_EQ(info.intrinsics->focal_px, 512.5);
  Image<float> metres;
  Counter counter;
  std::mutex mutex;
  ASSERT_TRUE((*camera)->start(counter.sink([&](const device::FramePtr& frame) {
    const std::lock_guard lock(mutex);
    if ((frame->flags & device::kFrameIncomplete) != 0) return;
    EXPECT_TRUE(to_metres(*frame, info, metres));
  })));
  EXPECT_TRUE(counter.wait_for(5));
  (*camera)->stop();
  ASSERT_EQ(metres.size(), (Size{64, 48}));
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      ASSERT_FLOAT_EQ(metres.at(x, y), static_cast<float>((1000 + x + y) * 0.00025));
}

TEST(AravisOpen, AMissingCameraIsNamedInTheError) {
  SystemClock clock;
  const auto camera = device::open_aravis("Nobody-0", {}, clock);
  ASSERT_FALSE(camera);
  EXPECT_EQ(camera.error().code, ErrorCode::kNotFound);
}

TEST(AravisReturn, ACameraDeliversAgainAfterADisconnect) {
  SystemClock clock;
  auto device = std::make_unique<Device>("GV03");
  auto camera = device::open_aravis("Aravis-Fake-GV03", small(device::PixelFormat::kGray8), clock);
  ASSERT_TRUE(camera) << to_line(camera.error());
  Counter counter;
  ASSERT_TRUE((*camera)->start(counter.sink()));
  ASSERT_TRUE(counter.wait_for(3));
  device.reset();
  const HostTime lost_by = clock.now() + 60s;
  while ((*camera)->health().state != device::DeviceState::kLost && clock.now() < lost_by)
    clock.sleep_until(clock.now() + 20ms);
  ASSERT_EQ((*camera)->health().state, device::DeviceState::kLost);
  device = std::make_unique<Device>("GV03");
  const HostTime back = clock.now();
  const auto before = static_cast<int>((*camera)->health().frames);
  ASSERT_TRUE(counter.wait_for(before + 1));
  std::printf("  measured: a frame %.2f s after the camera was back\n",
              seconds(clock.now() - back));
  EXPECT_EQ((*camera)->health().returns, 1U);
  (*camera)->stop();
}

}  // namespace
}  // namespace mixrig::test

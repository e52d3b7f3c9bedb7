// SPDX-License-Identifier: Apache-2.0
// The aravis driver against libaravis' own GigE Vision camera on the loopback interface. Run it in
// its own network namespace: the search for cameras broadcasts.
#include <bit>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <arv.h>
#include <gtest/gtest.h>

#include "hal/linux/aravis/aravis_camera.h"
#include "hal/wire/camera/genicam_buffer.h"
#include "tests/support/genicam/emulated_genicam.h"
#include "tests/support/progress.h"
#include "tests/unit/hal_device/camera_contract.h"
#include "tests/unit/hal_device/depth_camera_contract.h"

namespace mixrig::test {
namespace {

using namespace std::chrono_literals;

std::string intrinsics() {
  return genicam_number("Scan3dFocalLength", "512.5") +
         genicam_number("Scan3dPrincipalPointU", "319.5") +
         genicam_number("Scan3dPrincipalPointV", "239.5");
}

const GenicamFeatures kPlainDepth = {{{"Coord3D_C16", device::pfnc::kCoord3dC16}},
                                     genicam_number("Scan3dCoordinateScale", "0.25") +
                                         genicam_number("Scan3dCoordinateOffset", "0.0") +
                                         intrinsics()};

// Basler blaze, by its documentation: components that are selected and enabled, points in
// millimetres as floats or z of 10 m in 65535 steps, invalid ones are 0.
GenicamFeatures blaze(const char* format, std::uint32_t code, const char* scale) {
  return {{{format, code}},
          genicam_components() + genicam_number("Scan3dCoordinateScale", scale) +
              genicam_number("Scan3dCoordinateOffset", "0.0") +
              genicam_number("Scan3dInvalidDataValue", "0.0") + intrinsics()};
}

/// Pixel (x, y) has depth step 1000 + x + y, amplitude 7 (x + y) and, as a float, 250 + x + y mm;
/// pixel (0, 0) is invalid.
void fill_ramp(ArvBuffer* buffer, void*, guint32, guint32, ArvPixelFormat format) {
  size_t unused = 0;  // the library sets it to 0 here: the declared geometry is used
  auto* bytes = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &unused)));
  const int width = arv_buffer_get_image_width(buffer),
            height = arv_buffer_get_image_height(buffer);
  const auto word = [&](int value) {
    *bytes++ = static_cast<std::uint8_t>(value);
    *bytes++ = static_cast<std::uint8_t>(value >> 8);
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool invalid = x == 0 && y == 0;
      if (format == device::pfnc::kCoord3dC16) {
        word(1000 + x + y);
      } else if (format == device::pfnc::kCoord3dAbcy16) {
        word(11), word(22), word(invalid ? 65535 : 1000 + x + y), word(7 * (x + y));
      } else if (format == device::pfnc::kCoord3dAbc32f) {
        for (const float value : {11.0F, 22.0F, static_cast<float>(invalid ? 0 : 250 + x + y)}) {
          std::memcpy(bytes, &value, sizeof value);
          bytes += sizeof value;
        }
      }
    }
}

struct Device : EmulatedGenicam {
  explicit Device(const std::string& serial, const GenicamFeatures& features = kPlainDepth)
      : EmulatedGenicam(serial, features, fill_ramp) {}
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

/// One whole frame of a depth camera: depth in metres, and amplitude.
struct Seen {
  device::DepthInfo info;
  Image<float> depth_m{};
  std::vector<std::uint8_t> amplitude{};
};
Seen seen_by(const std::string& serial) {
  static SystemClock clock;
  auto camera =
      device::open_aravis_depth("Aravis-Fake-" + serial, {.size = {64, 48}, .rate_hz = 25}, clock);
  EXPECT_TRUE(camera) << to_line(camera.error());
  if (!camera) return {};
  Seen seen{.info = (*camera)->depth()};
  Counter counter;
  std::mutex mutex;
  EXPECT_TRUE((*camera)->start(counter.sink([&](const device::FramePtr& frame) {
    const std::lock_guard lock(mutex);
    if ((frame->flags & device::kFrameIncomplete) != 0) return;
    EXPECT_TRUE(to_metres(*frame, seen.info, seen.depth_m));
    seen.amplitude.assign(frame->amplitude.begin(), frame->amplitude.end());
  })));
  EXPECT_TRUE(counter.wait_for(5));
  (*camera)->stop();
  EXPECT_EQ(seen.depth_m.size(), (Size{64, 48}));
  return seen;
}

TEST(AravisDepth, ScaleAndIntrinsicsAreReadFromTheCamera) {
  const Device device("GV02");
  ASSERT_TRUE(device.running());
  const Seen seen = seen_by("GV02");
  EXPECT_DOUBLE_EQ(seen.info.metres_per_step, 0.00025);
  ASSERT_TRUE(seen.info.intrinsics);
  EXPECT_DOUBLE_EQ(seen.info.intrinsics->focal_px, 512.5);
  EXPECT_TRUE(seen.amplitude.empty());
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      ASSERT_FLOAT_EQ(seen.depth_m.at(x, y), static_cast<float>((1000 + x + y) * 0.00025));
}

TEST(AravisDepth, ACameraLikeHelios2GivesDepthAndAmplitudeInOneFrame) {
  const Device device("GV05", helios2_features());
  ASSERT_TRUE(device.running());
  const Seen seen = seen_by("GV05");
  EXPECT_DOUBLE_EQ(seen.info.metres_per_step, 0.00025);
  EXPECT_EQ(seen.info.unknown_steps, std::vector<int>{65535});
  EXPECT_EQ(seen.info.meaning, device::DepthMeaning::kZ);
  EXPECT_EQ(seen.depth_m.at(0, 0), 0.0F);
  ASSERT_EQ(seen.amplitude.size(), 2U * 64 * 48);
  for (int y = 0; y < 48; ++y)
    for (int x = y == 0 ? 1 : 0; x < 64; ++x) {
      const auto at = static_cast<std::size_t>(2 * (64 * y + x));
      ASSERT_FLOAT_EQ(seen.depth_m.at(x, y), static_cast<float>((1000 + x + y) * 0.00025));
      ASSERT_EQ(seen.amplitude[at] | seen.amplitude[at + 1] << 8, 7 * (x + y));
    }
}

TEST(AravisDepth, ACameraLikeBlazeIsSetToItsRangeAndReadInItsScale) {
  const Device device("GV06", blaze("Coord3D_C16", device::pfnc::kCoord3dC16, "0.152590219"));
  ASSERT_TRUE(device.running());
  const Seen seen = seen_by("GV06");
  EXPECT_NEAR(seen.info.metres_per_step, 10.0 / 65535, 1e-10);
  EXPECT_FLOAT_EQ(seen.depth_m.at(3, 5), static_cast<float>(1008 * 0.000152590219));
  EXPECT_NE(device.memory(kGenicamComponentsAt), 0U) << "Range is on";
  EXPECT_EQ(device.memory(kGenicamComponentsAt + 4), 0U) << "one part a buffer: Intensity is off";
  EXPECT_EQ(device.memory(kGenicamComponentsAt + 8), 0U);
}

TEST(AravisDepth, PointsAsFloatsBecomeSteps) {
  const Device device("GV07", blaze("Coord3D_ABC32f", device::pfnc::kCoord3dAbc32f, "1.0"));
  ASSERT_TRUE(device.running());
  const Seen seen = seen_by("GV07");
  EXPECT_EQ(seen.depth_m.at(0, 0), 0.0F);
  for (int x = 1; x < 64; ++x) ASSERT_NEAR(seen.depth_m.at(x, 7), 0.257 + 0.001 * x, 1e-6) << x;
}

TEST(AravisDepth, WhatIsNoDepthOrHasNoUnitIsRefused) {
  static SystemClock clock;
  struct Case {
    const char* serial;
    std::string xml;
    const char* in_the_line;
  };
  for (const Case& c :
       {Case{"GV08", intrinsics(), "does not report Scan3dCoordinateScale"},
        Case{"GV09", kPlainDepth.xml + genicam_choice("Scan3dOutputMode", "DisparityC"),
             "sends disparities"},
        Case{"GV10", kPlainDepth.xml + genicam_choice("Scan3dDistanceUnit", "Pixel"),
             "Scan3dDistanceUnit is Pixel"}}) {
    const Device device(c.serial, {kPlainDepth.formats, c.xml});
    ASSERT_TRUE(device.running());
    const auto camera = device::open_aravis_depth(std::string("Aravis-Fake-") + c.serial,
                                                  {.size = {64, 48}}, clock);
    ASSERT_FALSE(camera) << c.serial;
    EXPECT_NE(to_line(camera.error()).find(c.in_the_line), std::string::npos)
        << to_line(camera.error());
  }
}

// Registers of the emulated camera that the tests use.
constexpr std::uint32_t kChunksAt = 0x9000, kPtpAt = 0x9100;

std::string chunk(const std::string& name, const std::string& id, int bytes, bool is_float) {
  const std::string kind = is_float ? "FloatReg" : "IntReg";
  return "<Port Name=\"Port" + name + "\"><ChunkID>" + id + "</ChunkID></Port>\n<" + kind +
         " Name=\"Chunk" + name + "\"><Address>0</Address><Length>" + std::to_string(bytes) +
         "</Length><AccessMode>RO</AccessMode><pPort>Port" + name + "</pPort>" +
         (is_float ? "" : "<Sign>Unsigned</Sign>") + "<Endianess>BigEndian</Endianess></" + kind +
         ">\n";
}

/// SFNC 2.7: chunks of stamp, exposure and counter; PTP that is on and follows a master.
const GenicamFeatures kChunks = {
    {},
    genicam_register("IntReg", "ChunkModeRegister", kChunksAt) +
        "<Boolean Name=\"ChunkModeActive\"><pValue>ChunkModeRegister</pValue></Boolean>\n"
        "<Enumeration Name=\"ChunkSelector\">"
        "<EnumEntry Name=\"Timestamp\"><Value>1</Value></EnumEntry>"
        "<EnumEntry Name=\"ExposureTime\"><Value>2</Value></EnumEntry>"
        "<EnumEntry Name=\"FrameID\"><Value>3</Value></EnumEntry>"
        "<pValue>Chunk</pValue></Enumeration>\n"
        "<Integer Name=\"Chunk\"><Value>1</Value></Integer>\n"
        "<Boolean Name=\"ChunkEnable\"><pValue>ChunkRegister</pValue></Boolean>\n" +
        genicam_register("IntReg", "ChunkRegister", kChunksAt,
                         "<pIndex Offset=\"4\">Chunk</pIndex>") +
        chunk("Timestamp", "a1", 8, false) + chunk("ExposureTime", "a2", 8, true) +
        chunk("FrameID", "a3", 8, false) + genicam_register("IntReg", "PtpRegister", kPtpAt) +
        "<Boolean Name=\"PtpEnable\"><Value>1</Value></Boolean>\n" +
        genicam_choice("PtpStatus", "Slave"),
    64 * 48 + 3 * 16};

/// Value, id and length of each chunk, as they follow a picture.
std::vector<std::uint8_t> chunks_of(std::uint64_t stamp, double exposure_us,
                                    std::uint64_t counter) {
  std::vector<std::uint8_t> bytes;
  const auto put = [&](std::uint64_t value, int count) {
    for (int i = count - 1; i >= 0; --i) bytes.push_back(static_cast<std::uint8_t>(value >> 8 * i));
  };
  put(stamp, 8), put(0xA1, 4), put(8, 4);
  put(std::bit_cast<std::uint64_t>(exposure_us), 8), put(0xA2, 4), put(8, 4);
  put(counter, 8), put(0xA3, 4), put(8, 4);
  return bytes;
}

TEST(AravisChunks, GiveTheStampOfTheMiddleTheExposureAndTheCounter) {
  static SystemClock clock;
  const Device device("GV12", kChunks);
  ASSERT_TRUE(device.running());
  device::StreamRequest request = small(device::PixelFormat::kGray8);
  request.hardware_trigger = true;  // so that the emulated camera itself sends nothing
  auto camera = device::open_aravis("Aravis-Fake-GV12", request, clock);
  ASSERT_TRUE(camera) << to_line(camera.error());
  EXPECT_EQ((*camera)->info().ptp, "Slave");
  EXPECT_NE(device.memory(kChunksAt), 0U) << "ChunkModeActive";
  for (const std::uint32_t at : {4U, 8U, 12U}) EXPECT_NE(device.memory(kChunksAt + at), 0U) << at;
  std::mutex mutex;
  std::vector<device::Frame> frames;
  ASSERT_TRUE((*camera)->start([&](const device::FramePtr& frame) {
    const std::lock_guard lock(mutex);
    frames.push_back(*frame);
  }));
  GvspSender sender;
  const std::vector<std::uint8_t> picture(64 * 48);
  const auto send = [&](std::uint16_t id, std::uint64_t stamp, double exposure_us,
                        std::uint64_t counter) {
    sender.send_picture(device.host(), id, 77, {device::pfnc::kMono8, {64, 48}, picture},
                        chunks_of(stamp, exposure_us, counter));
  };
  constexpr std::uint64_t kStamp = 1'732'000'000'123'456'789;  // TAI of PTP
  send(1, kStamp, 5000, 70001);
  send(2, kStamp + 40'000'000, 8000, 70003);
  ASSERT_TRUE(comes_true([&] { return (*camera)->health().frames >= 2; }));
  (*camera)->stop();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].flags | frames[1].flags, device::kFrameAfterGap);
  EXPECT_EQ(frames[0].sequence, 70001U);
  EXPECT_EQ(frames[0].exposure, 5ms);
  EXPECT_EQ(frames[0].device_time.time_since_epoch().count(),
            static_cast<long>(kStamp) + 2'500'000);
  EXPECT_EQ(frames[1].device_time.time_since_epoch().count(),
            static_cast<long>(kStamp) + 44'000'000);
  EXPECT_EQ((*camera)->health().lost, 1U) << "by the camera's own counter";
}

TEST(AravisDepth, PartsOfABufferBecomeDepthAmplitudeAndConfidenceOfOneFrame) {
  static SystemClock clock;
  GenicamFeatures features = helios2_features();
  features.formats = {{"Coord3D_C16", device::pfnc::kCoord3dC16},
                      {"Confidence16", device::pfnc::kConfidence16}};
  features.xml += genicam_components();
  features.payload_bytes = 3 * 2 * 64 * 48;
  features.multipart = true;
  features.sends_alone = false;
  const Device device("GV13", features);
  ASSERT_TRUE(device.running());
  auto camera =
      device::open_aravis_depth("Aravis-Fake-GV13", {.size = {64, 48}, .rate_hz = 25}, clock);
  ASSERT_TRUE(camera) << to_line(camera.error());
  for (const std::uint32_t at : {0U, 4U, 8U})
    EXPECT_NE(device.memory(kGenicamComponentsAt + at), 0U) << at;
  device::FramePtr seen;
  std::mutex mutex;
  ASSERT_TRUE((*camera)->start([&](const device::FramePtr& frame) {
    const std::lock_guard lock(mutex);
    seen = frame;
  }));
  std::vector<std::uint8_t> depth(2 * 64 * 48), light(depth.size()), sure(depth.size());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth[i] = static_cast<std::uint8_t>(i), light[i] = static_cast<std::uint8_t>(3 * i);
    sure[i] = static_cast<std::uint8_t>(7 * i + 1);
  }
  const GvspPicture parts[] = {{device::pfnc::kMono16, {64, 48}, light, 1, 2},
                               {device::pfnc::kCoord3dC16, {64, 48}, depth, 5, 1},
                               {device::pfnc::kConfidence16, {64, 48}, sure, 9, 3}};
  GvspSender().send_parts(device.host(), 70001, 4'000'000, parts);
  ASSERT_TRUE(comes_true([&] { return (*camera)->health().frames >= 1; }));
  (*camera)->stop();
  EXPECT_EQ(seen->flags, device::kFrameOk);
  EXPECT_EQ(seen->sequence, 70001U);
  EXPECT_EQ(seen->device_time, DeviceTime(std::chrono::milliseconds(4)));
  const auto same = [](const auto& a, const auto& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  };
  EXPECT_TRUE(same(seen->bytes, depth));
  EXPECT_TRUE(same(seen->amplitude, light));
  EXPECT_TRUE(same(seen->confidence, sure));
}

TEST(AravisTrigger, AnInputThatTheCameraDoesNotHaveIsNamedWithThoseThatItHas) {
  SystemClock clock;
  const Device device("GV11");
  device::StreamRequest request = small(device::PixelFormat::kGray8);
  request.hardware_trigger = true;
  request.trigger_input = "Line7";
  const auto camera = device::open_aravis("Aravis-Fake-GV11", request, clock);
  ASSERT_FALSE(camera);
  EXPECT_NE(to_line(camera.error()).find("setting the trigger to Line7"), std::string::npos);
  EXPECT_NE(to_line(camera.error()).find("give trigger_input one of "), std::string::npos)
      << to_line(camera.error());
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

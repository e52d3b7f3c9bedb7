// SPDX-License-Identifier: Apache-2.0
// The aravis driver against libaravis' own GigE Vision camera on the loopback interface. Run it in
// its own network namespace: the search for cameras broadcasts.
#include <bit>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <arv.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
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

/// What a camera description has beside the built-in one.
struct Features {
  std::vector<std::pair<std::string, std::uint32_t>> formats;
  std::string xml;        ///< nodes
  int payload_bytes = 0;  ///< of a buffer, where it is not the picture alone
};

std::string number(const std::string& name, const std::string& value) {
  return "<Float Name=\"" + name + "\"><Value>" + value + "</Value></Float>\n";
}

/// An enumeration of one entry.
std::string choice(const std::string& name, const std::string& entry) {
  return "<Enumeration Name=\"" + name + "\"><EnumEntry Name=\"" + entry +
         "\"><Value>0</Value></EnumEntry><Value>0</Value></Enumeration>\n";
}

std::string intrinsics() {
  return number("Scan3dFocalLength", "512.5") + number("Scan3dPrincipalPointU", "319.5") +
         number("Scan3dPrincipalPointV", "239.5");
}

const Features kPlainDepth = {{{"Coord3D_C16", device::pfnc::kCoord3dC16}},
                              number("Scan3dCoordinateScale", "0.25") +
                                  number("Scan3dCoordinateOffset", "0.0") + intrinsics()};

// LUCID Helios2, by its technical manual: 0.25 mm a step, invalid points are 65535.
const Features kHelios2 = {
    {{"Coord3D_C16", device::pfnc::kCoord3dC16}, {"Coord3D_ABCY16", device::pfnc::kCoord3dAbcy16}},
    number("Scan3dCoordinateScale", "0.25") + number("Scan3dCoordinateOffset", "0.0") +
        "<Boolean Name=\"Scan3dInvalidDataFlag\"><Value>1</Value></Boolean>\n" +
        number("Scan3dInvalidDataValue", "65535.0") + choice("Scan3dDistanceUnit", "Millimeter") +
        choice("Scan3dOutputMode", "CalibratedABC_Grid") +
        choice("Scan3dCoordinateSystem", "Cartesian") +
        choice("Scan3dCoordinateSelector", "CoordinateC") + intrinsics()};

constexpr guint64 kComponentsAt = 0x8000;  // a register of each component in the camera's memory

// Basler blaze, by its documentation: components that are selected and enabled, points in
// millimetres as floats or z of 10 m in 65535 steps, invalid ones are 0.
Features blaze(const char* format, std::uint32_t code, const char* scale) {
  const std::string xml =
      "<Enumeration Name=\"ComponentSelector\">"
      "<EnumEntry Name=\"Range\"><Value>0</Value></EnumEntry>"
      "<EnumEntry Name=\"Intensity\"><Value>1</Value></EnumEntry>"
      "<EnumEntry Name=\"Confidence\"><Value>2</Value></EnumEntry>"
      "<pValue>Component</pValue></Enumeration>\n"
      "<Integer Name=\"Component\"><Value>2</Value></Integer>\n"
      "<Boolean Name=\"ComponentEnable\"><pValue>ComponentRegister</pValue></Boolean>\n"
      "<IntReg Name=\"ComponentRegister\"><Address>" +
      std::to_string(kComponentsAt) +
      "</Address><pIndex Offset=\"4\">Component</pIndex><Length>4</Length>"
      "<AccessMode>RW</AccessMode><pPort>Device</pPort><Sign>Unsigned</Sign>"
      "<Endianess>BigEndian</Endianess></IntReg>\n";
  return {{{format, code}},
          xml + number("Scan3dCoordinateScale", scale) + number("Scan3dCoordinateOffset", "0.0") +
              number("Scan3dInvalidDataValue", "0.0") + intrinsics()};
}

/// A file with the built-in camera description plus features.
std::string description(const Features& features) {
  const FakeDevice plain(arv_gv_fake_camera_new("127.0.0.1", "PLAIN"));
  size_t size = 0;
  const char* xml =
      arv_fake_camera_get_genicam_xml(arv_gv_fake_camera_get_fake_camera(plain.get()), &size);
  std::string text(xml, size);
  const auto formats = text.find("<Enumeration Name=\"PixelFormat\"");
  for (const auto& [name, code] : features.formats)
    text.insert(text.find("<EnumEntry", formats),
                "<EnumEntry Name=\"" + name + "\" NameSpace=\"Standard\"><Value>" +
                    std::to_string(code) + "</Value></EnumEntry>\n");
  text.insert(formats, features.xml);
  if (features.payload_bytes > 0) {
    const std::string name = "Name=\"PayloadSize\"";
    text.replace(text.find(name), name.size(), "Name=\"PictureSize\"");
    text.insert(text.find("<Enumeration Name=\"PixelFormat\""),
                "<Integer Name=\"PayloadSize\"><Value>" + std::to_string(features.payload_bytes) +
                    "</Value></Integer>\n");
  }
  static int count = 0;
  const auto path =
      std::filesystem::temp_directory_path() /
      ("mixrig_tof_" + std::to_string(::getpid()) + "_" + std::to_string(++count) + ".xml");
  std::ofstream(path) << text;
  return path;
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

class Device {
 public:
  explicit Device(const std::string& serial, const Features& features = kPlainDepth)
      : description_(description(features)) {
    camera_.reset(arv_gv_fake_camera_new_full("127.0.0.1", serial.c_str(), description_.c_str()));
    arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(camera_.get()), fill_ramp,
                                     nullptr);
  }
  ~Device() { std::filesystem::remove(description_); }
  bool running() const { return arv_gv_fake_camera_is_running(camera_.get()); }
  /// A register of the camera's control channel, in this machine's order.
  std::uint32_t word(guint32 address) const {
    guint32 value = 0;
    arv_fake_camera_read_register(arv_gv_fake_camera_get_fake_camera(camera_.get()), address,
                                  &value);
    return value;
  }
  std::uint32_t memory(guint64 address) const {
    std::uint32_t value = 0;
    arv_fake_camera_read_memory(arv_gv_fake_camera_get_fake_camera(camera_.get()),
                                static_cast<guint32>(address), sizeof value, &value);
    return value;
  }

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

/// One whole frame of a depth camera: in metres, and its amplitude.
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
  const Device device("GV05", kHelios2);
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
  EXPECT_NE(device.memory(kComponentsAt), 0U) << "Range is on";
  EXPECT_EQ(device.memory(kComponentsAt + 4), 0U) << "one part a buffer: Intensity is off";
  EXPECT_EQ(device.memory(kComponentsAt + 8), 0U);
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
  for (const Case& c : {Case{"GV08", intrinsics(), "does not report Scan3dCoordinateScale"},
                        Case{"GV09", kPlainDepth.xml + choice("Scan3dOutputMode", "DisparityC"),
                             "sends disparities"},
                        Case{"GV10", kPlainDepth.xml + choice("Scan3dDistanceUnit", "Pixel"),
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
constexpr guint32 kStreamPort = 0x0D00, kStreamAddress = 0x0D18;
constexpr guint64 kChunksAt = 0x9000, kPtpAt = 0x9100;

std::string reg(const std::string& kind, const std::string& name, guint64 address,
                const std::string& more = {}) {
  return "<" + kind + " Name=\"" + name + "\"><Address>" + std::to_string(address) + "</Address>" +
         more + "<Length>4</Length><AccessMode>RW</AccessMode><pPort>Device</pPort>" +
         "<Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></" + kind + ">\n";
}
std::string chunk(const std::string& name, const std::string& id, int bytes, bool is_float) {
  const std::string kind = is_float ? "FloatReg" : "IntReg";
  return "<Port Name=\"Port" + name + "\"><ChunkID>" + id + "</ChunkID></Port>\n<" + kind +
         " Name=\"Chunk" + name + "\"><Address>0</Address><Length>" + std::to_string(bytes) +
         "</Length><AccessMode>RO</AccessMode><pPort>Port" + name + "</pPort>" +
         (is_float ? "" : "<Sign>Unsigned</Sign>") + "<Endianess>BigEndian</Endianess></" + kind +
         ">\n";
}

/// SFNC 2.7: chunks of stamp, exposure and counter; PTP that is on and follows a master.
const Features kChunks = {
    {},
    reg("IntReg", "ChunkModeRegister", kChunksAt) +
        "<Boolean Name=\"ChunkModeActive\"><pValue>ChunkModeRegister</pValue></Boolean>\n"
        "<Enumeration Name=\"ChunkSelector\">"
        "<EnumEntry Name=\"Timestamp\"><Value>1</Value></EnumEntry>"
        "<EnumEntry Name=\"ExposureTime\"><Value>2</Value></EnumEntry>"
        "<EnumEntry Name=\"FrameID\"><Value>3</Value></EnumEntry>"
        "<pValue>Chunk</pValue></Enumeration>\n"
        "<Integer Name=\"Chunk\"><Value>1</Value></Integer>\n"
        "<Boolean Name=\"ChunkEnable\"><pValue>ChunkRegister</pValue></Boolean>\n" +
        reg("IntReg", "ChunkRegister", kChunksAt, "<pIndex Offset=\"4\">Chunk</pIndex>") +
        chunk("Timestamp", "a1", 8, false) + chunk("ExposureTime", "a2", 8, true) +
        chunk("FrameID", "a3", 8, false) + reg("IntReg", "PtpRegister", kPtpAt) +
        "<Boolean Name=\"PtpEnable\"><Value>1</Value></Boolean>\n" + choice("PtpStatus", "Slave"),
    64 * 48 + 3 * 16};

/// Sends pictures as the GigE Vision standard lays out GVSP packets, in place of the emulated
/// camera, whose own stream has no chunks.
class ChunkSender {
 public:
  explicit ChunkSender(const Device& device) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_port = htons(static_cast<std::uint16_t>(device.word(kStreamPort)));
    address_.sin_addr.s_addr = htonl(device.word(kStreamAddress));
  }
  ~ChunkSender() { ::close(socket_); }
  /// A grey picture of 64x48 and its chunks; `id` is the block's, 16 bits.
  void send(int id, std::uint64_t stamp, double exposure_us, std::uint64_t counter) {
    std::vector<std::uint8_t> picture(64 * 48, static_cast<std::uint8_t>(id));
    append(picture, stamp, 0xA1);
    append(picture, std::bit_cast<std::uint64_t>(exposure_us), 0xA2);
    append(picture, counter, 0xA3);
    std::vector<std::uint8_t> leader = header(id, 1, 0);
    for (const std::uint32_t word : {0x4001U, 0U, 77U, 0x01080001U, 64U, 48U, 0U, 0U, 0U})
      put(leader, word, 4);
    packet(leader);
    const std::size_t room = payload_;
    int number = 1;
    for (std::size_t at = 0; at < picture.size(); at += room, ++number) {
      std::vector<std::uint8_t> block = header(id, 3, number);
      block.insert(block.end(), picture.begin() + static_cast<long>(at),
                   picture.begin() + static_cast<long>(std::min(picture.size(), at + room)));
      packet(block);
    }
    std::vector<std::uint8_t> trailer = header(id, 2, number);
    put(trailer, 0x4001U, 4), put(trailer, 48U, 4);
    packet(trailer);
  }
  void payload(std::size_t bytes) { payload_ = bytes; }

 private:
  static void put(std::vector<std::uint8_t>& bytes, std::uint64_t value, int count) {
    for (int i = count - 1; i >= 0; --i) bytes.push_back(static_cast<std::uint8_t>(value >> 8 * i));
  }
  /// The value, then id and length of the chunk.
  static void append(std::vector<std::uint8_t>& bytes, std::uint64_t value, std::uint32_t id) {
    put(bytes, value, 8), put(bytes, id, 4), put(bytes, 8, 4);
  }
  static std::vector<std::uint8_t> header(int id, std::uint32_t kind, int number) {
    std::vector<std::uint8_t> bytes;
    put(bytes, 0, 2), put(bytes, static_cast<std::uint64_t>(id), 2);
    put(bytes, kind << 24 | static_cast<std::uint32_t>(number), 4);
    return bytes;
  }
  void packet(const std::vector<std::uint8_t>& bytes) const {
    ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address_),
             sizeof address_);
  }
  int socket_;
  std::size_t payload_ = 1000;
  sockaddr_in address_{};
};

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
  for (const guint64 at : {4U, 8U, 12U}) EXPECT_NE(device.memory(kChunksAt + at), 0U) << at;
  std::mutex mutex;
  std::vector<device::Frame> frames;
  ASSERT_TRUE((*camera)->start([&](const device::FramePtr& frame) {
    const std::lock_guard lock(mutex);
    frames.push_back(*frame);
  }));
  ChunkSender sender(device);
  const std::size_t packet = device.word(0x0D04) & 0xFFFF;
  sender.payload(packet - 36);  // without the headers of IP, UDP and GVSP
  constexpr std::uint64_t kStamp = 1'732'000'000'123'456'789;  // TAI of PTP
  sender.send(1, kStamp, 5000, 70001);
  sender.send(2, kStamp + 40'000'000, 8000, 70003);
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

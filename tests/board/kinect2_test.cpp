// SPDX-License-Identifier: Apache-2.0
// The Kinect v2 driver through libusb, usbfs and the kernel's virtual host controller: raw pictures
// of the studio in isochronous packets, colour over bulk transfers. The take lies in the folder
// that MIXRIG_BOARD_KINECT names: `mixrig studio --raw`, rig kinect2.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "extras/kinect2/kinect2_camera.h"
#include "extras/kinect2/libusb_streams.h"
#include "hal/wire/camera/kinect2_raw.h"
#include "extras/kinect2/kinect2_depth.h"
#include "host/math/image_io/image_io.h"
#include "tests/board/bench.h"
#include "tests/board/kinect2_device.h"
#include "tests/board/nodes.h"
#include "tests/support/genicam/recorded_truth.h"
#include "tests/support/kinect2_pictures.h"

namespace mixrig::board {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

constexpr int kRawFrames = 3, kBeforeFirst = 7;  // frames 8 to 10 show a person
constexpr double kWrong_m = 0.1;
SystemClock g_kinect_clock;

std::string folder() {
  const char* name = std::getenv("MIXRIG_BOARD_KINECT");
  return name != nullptr ? name : "";
}

Bytes bytes_of(const std::string& name) {
  std::ifstream file(folder() + "/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string numbered(const char* pattern, int number) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, number);
  return text;
}

device::EmulatedKinect2::Answers answers() {
  return {.phase_offsets = bytes_of("raw/phase_offsets.bin"),
          .infrared = bytes_of("raw/infrared.bin"),
          .color = Bytes(12981)};
}

/// Errors of distances along the ray against the truth at the pixels' centres.
struct Score {
  long pixels = 0, missing = 0, wrong = 0, known = 0;
  double sum_m = 0, absolute_m = 0, square_m2 = 0;
  void add(const Image<float>& distance_m, const Image<std::uint16_t>& truth) {
    for (int y = 0; y < truth.height(); ++y)
      for (int x = 0; x < truth.width(); ++x) {
        if (truth.at(x, y) == 0) continue;
        ++pixels;
        const double d = distance_m.at(x, y), e = d - 0.00025 * truth.at(x, y);
        if (d == 0) {
          ++missing;
        } else if (std::abs(e) > kWrong_m) {
          ++wrong;
        } else {
          ++known, sum_m += e, absolute_m += std::abs(e), square_m2 += e * e;
        }
      }
  }
  double percent(long n) const {
    return 100.0 * static_cast<double>(n) / static_cast<double>(pixels);
  }
  double mm(double sum_of_m) const { return 1e3 * sum_of_m / static_cast<double>(known); }
};

class Kinect2 : public ::testing::Test {
 protected:
  void SetUp() override {
    if (folder().empty()) GTEST_SKIP() << "MIXRIG_BOARD_KINECT names no take";
    ASSERT_TRUE(plug());
    auto usb = device::make_libusb_kinect2("");
    ASSERT_TRUE(usb) << to_line(usb.error());
    auto opened = device::open_kinect2(*std::move(usb), "kinect2:", g_kinect_clock,
                                       device::make_kinect2_decoder);
    ASSERT_TRUE(opened) << to_line(opened.error());
    depth_ = device::kinect2_depth_camera(*opened);
    color_ = device::kinect2_color_camera(*std::move(opened));
    for (int n = 1; n <= kRawFrames; ++n)
      raw_.push_back(bytes_of(numbered("raw/%06d.bin", kBeforeFirst + n)));
    ASSERT_EQ(raw_.back().size(), 10 * device::kKinect2PacketBytes);
    ASSERT_TRUE(depth_->start([this](const device::FramePtr& frame) {
      const std::lock_guard lock(mutex_);
      frames_.push_back(frame);
    }));
  }
  void TearDown() override {
    if (color_) color_->stop();
    if (depth_) depth_->stop();
  }
  bool plug() {
    const auto plugged = port_.plug();
    EXPECT_TRUE(plugged) << to_line(plugged.error());
    return plugged && wait_until([] { return has_usb("Virtual Kinect v2"); });
  }
  void send(int number, int lost = -1) {
    sent_ = number, returns_ = depth_->health().returns;
    device_.camera().send_depth(raw_[static_cast<std::size_t>(number - 1)], lost);
    port_.wake();
  }
  /// Waits for `count` frames. If the driver has restarted the device meanwhile, the last frame is
  /// sent again: the driver restarts after a second of silence, and the guest's clock runs ahead
  /// where the host is slow.
  bool frames(std::size_t count) {
    return wait_until([&] {
      {
        const std::lock_guard lock(mutex_);
        if (frames_.size() >= count) return true;
      }
      if (depth_->health().returns > returns_) send(sent_);
      return false;
    });
  }

  Kinect2Device device_{answers()};
  VhciPort port_{5, device_};
  std::unique_ptr<device::DepthCamera> depth_;
  std::unique_ptr<device::Camera> color_;
  std::vector<Bytes> raw_;
  int sent_ = 1;
  std::uint64_t returns_ = 0;
  std::mutex mutex_;
  std::vector<device::FramePtr> frames_;
};

TEST_F(Kinect2, RawPicturesInIsochronousPacketsBecomeTheDepthOfTheirTruth) {
  EXPECT_EQ(depth_->info().serial, "000000000001");
  const HostTime begin = g_kinect_clock.now();
  for (int n = 1; n <= kRawFrames; ++n) {
    send(n);
    ASSERT_TRUE(frames(static_cast<std::size_t>(n)));
  }
  const double took_s = seconds(g_kinect_clock.now() - begin);
  EXPECT_EQ(depth_->health().incomplete, 0U);
  EXPECT_EQ(depth_->health().link_errors, 0U);
  depth_->stop();
  Score score;
  for (int n = 1; n <= kRawFrames; ++n) {
    const auto& frame = frames_[static_cast<std::size_t>(n - 1)];
    EXPECT_EQ(frame->flags, device::kFrameOk);
    Image<float> distance_m;
    ASSERT_TRUE(device::to_metres(*frame, depth_->depth(), distance_m));
    Image<std::uint16_t> truth;
    ASSERT_TRUE(image_io::read_gray16(
        folder() + numbered("/truth/tof_distance/%06d.png", kBeforeFirst + n), truth));
    score.add(distance_m, truth);
  }
  measured(
      "%d frames in %.2f s; error %.2f mm mean, %.2f rms, %.2f bias; wrong %.3f %%, missing "
      "%.2f %% of %ld pixels",
      kRawFrames, took_s, score.mm(score.absolute_m),
      1e3 * std::sqrt(score.square_m2 / static_cast<double>(score.known)), score.mm(score.sum_m),
      score.percent(score.wrong), score.percent(score.missing), score.pixels);
  EXPECT_LT(score.mm(score.absolute_m), 6);
  EXPECT_LT(score.percent(score.wrong), 0.5);
  EXPECT_LT(score.percent(score.missing), 6);
}

/// The ten pictures arrive unchanged: decoding their bytes here gives the same steps.
TEST_F(Kinect2, DepthIsThatOfTheSamePacketsDecodedHere) {
  send(2);
  ASSERT_TRUE(frames(1));
  const auto infrared = device::parse_kinect2_infrared(answers().infrared);
  const auto offsets = device::parse_kinect2_offsets(answers().phase_offsets);
  ASSERT_TRUE(infrared && offsets);
  const auto decoder = device::make_kinect2_decoder(*infrared, *offsets);
  Bytes pictures, steps(2 * 512 * 424), amplitude(steps.size()), confidence(steps.size());
  for (std::size_t at = 0; at < raw_[1].size(); at += device::kKinect2PacketBytes)
    pictures.insert(pictures.end(), raw_[1].begin() + static_cast<long>(at),
                    raw_[1].begin() + static_cast<long>(at + device::kKinect2PictureBytes));
  decoder->decode(pictures, steps, amplitude, confidence);
  const auto same = [](const auto& a, const auto& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  };
  EXPECT_TRUE(same(frames_[0]->bytes, steps));
  EXPECT_TRUE(same(frames_[0]->amplitude, amplitude));
  EXPECT_TRUE(same(frames_[0]->confidence, confidence));
}

TEST_F(Kinect2, AColourPictureComesOverBulkBesideDepth) {
  device::FramePtr picture;
  ASSERT_TRUE(color_->start([&](const device::FramePtr& frame) {
    const std::lock_guard lock(mutex_);
    picture = frame;
  }));
  Bytes jpeg(300000);
  for (std::size_t i = 0; i < jpeg.size(); ++i) jpeg[i] = static_cast<std::uint8_t>(i * i >> 7);
  jpeg.back() = 0xD9, jpeg[jpeg.size() - 2] = 0xFF;
  send(1);
  device_.camera().send_color(test::kinect2_color_packet(jpeg, 7, 1862));
  port_.wake();
  ASSERT_TRUE(frames(1));
  ASSERT_TRUE(wait_until([&] {
    const std::lock_guard lock(mutex_);
    return picture != nullptr;
  }));
  EXPECT_EQ(picture->sequence, 7U);
  EXPECT_TRUE(std::equal(picture->bytes.begin(), picture->bytes.end(), jpeg.begin(), jpeg.end()));
}

TEST_F(Kinect2, ALostIsochronousPacketIsAnIncompleteFrame) {
  send(1);
  send(2, /*lost=*/44);
  send(3);
  ASSERT_TRUE(frames(3));
  EXPECT_EQ(depth_->health().incomplete, 1U);
  EXPECT_EQ(depth_->health().link_errors, 1U);
  EXPECT_EQ(frames_[1]->flags & device::kFrameIncomplete, device::kFrameIncomplete);
}

TEST_F(Kinect2, UnpluggedWhileItStreamsItIsLostAndComesBack) {
  send(1);
  ASSERT_TRUE(frames(1));
  port_.unplug();
  ASSERT_TRUE(wait_until([&] { return depth_->health().state == device::DeviceState::kLost; }));
  ASSERT_TRUE(plug());
  ASSERT_TRUE(wait_until([&] { return depth_->health().returns == 1; }));
  send(1);
  ASSERT_TRUE(frames(2));
  EXPECT_EQ(frames_[1]->flags, device::kFrameRestarted);
}

/// Plates by a GigE Vision camera and raw pictures by the Kinect's packets, both of one take, are
/// recorded and composited by the command; the take itself is composited for comparison.
TEST(Kinect2Rig, RawPacketsAreRecordedAndComposited) {
  if (folder().empty()) GTEST_SKIP() << "MIXRIG_BOARD_KINECT names no take";
  (void)run("ip addr add 127.0.0.2/8 dev lo");
  Kinect2Device device(answers());
  VhciPort port(5, device);
  ASSERT_TRUE(port.plug());
  std::vector<Bytes>
      frames;  // read early: the guest's clock runs ahead while it reads from the share
  for (int n = 1; fs::exists(folder() + "/" + numbered("raw/%06d.bin", n)); ++n)
    frames.push_back(bytes_of(numbered("raw/%06d.bin", n)));
  const auto expose = [&](int frame) {
    Bytes& raw = frames[static_cast<std::size_t>(frame - 1)];
    const auto ticks = static_cast<std::uint32_t>(g_kinect_clock.now().time_since_epoch() /
                                                  std::chrono::microseconds(125));
    for (std::size_t at = device::kKinect2PictureBytes + 8; at < raw.size();
         at += device::kKinect2PacketBytes)
      for (std::size_t i = 0; i < 4; ++i) raw[at + i] = static_cast<std::uint8_t>(ticks >> (8 * i));
    device.camera().send_depth(raw);
    port.wake();
  };
  const auto cameras =
      test::GenicamTake::open(folder(), 3, test::GenicamDepthLayout::kNone, expose);
  ASSERT_TRUE(cameras) << to_line(cameras.error());
  std::ofstream("/tmp/kinect.toml")
      << "format = 1\nname = \"kinect\"\n"
      << (*cameras)->rig_tables()
      << "[depth]\nname = \"tof\"\nuri = \"kinect2:000000000001\"\nlight = true\n"
      << test::camera_tables(folder()) << test::world_table(folder());
  const Ran ran = run("mixrig record --rig /tmp/kinect.toml /tmp/kinect2 --format png --duration " +
                      std::to_string((*cameras)->seconds()));
  ASSERT_EQ(ran.status, 0) << ran.text;
  std::printf("%s", ran.text.c_str());
  test::give_truth(folder(), "/tmp/kinect2", **cameras);
  (void)run("cp -r " + folder() + "/models " + folder() + "/scene.toml /tmp/kinect2/");
  const auto composited = [&](const std::string& name) {
    const Ran done = run("mixrig run " + name + "/scene.toml --source take:" + name +
                         " --out /tmp/out --backend cpu --format none --json /tmp/run.json");
    EXPECT_EQ(done.status, 0) << done.text;
    std::ifstream file("/tmp/run.json");
    return nlohmann::json::parse(file).at("error");
  };
  const auto there = composited("/tmp/kinect2"), own = composited(folder());
  const auto value = [](const nlohmann::json& error, const char* key) {
    return error.at(key).get<double>();
  };
  measured("key_iou %.4f, depth %.2f mm, bad %.2f %%; of the take itself %.4f, %.2f mm, %.2f %%",
           value(there, "key_iou"), value(there, "depth_mae_mm"), value(there, "depth_bad_pct"),
           value(own, "key_iou"), value(own, "depth_mae_mm"), value(own, "depth_bad_pct"));
  // Frames without depth are left out, and the last frame is repeated; hence the tolerances.
  EXPECT_GT(value(there, "key_iou"), value(own, "key_iou") - 0.03);
  EXPECT_LT(value(there, "depth_mae_mm"), value(own, "depth_mae_mm") + 2);
}

}  // namespace
}  // namespace mixrig::board

// SPDX-License-Identifier: Apache-2.0
// The v4l2 driver on the kernel's vivid camera: formats, gaps, a node that disappears and
// reappears.
#include "hal/linux/v4l2/v4l2_camera.h"
#include "tests/board/bench.h"

namespace mixrig::board {
namespace {

constexpr const char* kNode = "/dev/video0";
constexpr Size kSize{320, 180};
SystemClock g_clock;

void control(const std::string& setting) {
  const Ran ran = run(std::string("v4l2-ctl -d ") + kNode + " -c " + setting);
  ASSERT_EQ(ran.status, 0) << ran.text;
}

device::StreamRequest small(device::PixelFormat format) {
  return {.size = kSize, .format = format, .rate_hz = 30};
}

TEST(Vivid, StreamsEveryFormatThatItOffers) {
  using device::PixelFormat;
  for (const PixelFormat format :
       {PixelFormat::kYuyv, PixelFormat::kNv12, PixelFormat::kGray8, PixelFormat::kGray16,
        PixelFormat::kRgb8, PixelFormat::kBgr8, PixelFormat::kBayerRggb8, PixelFormat::kBayerGbrg8,
        PixelFormat::kBayerRggb16}) {
    auto camera = device::V4l2Camera::open(kNode, small(format), g_clock);
    ASSERT_TRUE(camera) << device::name(format) << ": " << to_line(camera.error());
    Frames frames;
    ASSERT_TRUE((*camera)->start(frames.sink()));
    ASSERT_TRUE(frames.wait_for_more(10)) << device::name(format);
    (*camera)->stop();
    const auto seen = frames.seen();
    const std::size_t bytes =
        device::image_bytes(format, kSize, device::row_bytes(format, kSize.width));
    for (const auto& frame : seen) {
      EXPECT_GE(frame.bytes, bytes) << device::name(format);
      EXPECT_EQ(frame.flags & device::kFrameIncomplete, 0U);
    }
    const double mean_s = seconds(seen.back().device_time - seen.front().device_time) /
                          static_cast<double>(seen.back().sequence - seen.front().sequence);
    EXPECT_NEAR(1 / mean_s, 30, 1.5) << device::name(format);
    measured("%s: %zu frames, %.2f Hz by their stamps", std::string(device::name(format)).c_str(),
             seen.size(), 1 / mean_s);
  }
}

/// Reloads the module as single-planar (1) or multi-planar (2).
void load_vivid(int planar) {
  const Ran ran =
      run("modprobe -r vivid && modprobe vivid n_devs=1 node_types=0x1 num_inputs=1 "
          "input_types=0 multiplanar=" +
          std::to_string(planar) + " && udevadm settle");
  ASSERT_EQ(ran.status, 0) << ran.text;
}

TEST(Vivid, AMultiPlanarNodeSendsOneAndTwoPlanes) {
  using device::PixelFormat;
  load_vivid(2);
  for (const PixelFormat format :
       {PixelFormat::kYuyv, PixelFormat::kNv12, PixelFormat::kGray16, PixelFormat::kBayerRggb16}) {
    auto camera = device::V4l2Camera::open(kNode, small(format), g_clock);
    EXPECT_TRUE(camera) << device::name(format) << ": " << to_line(camera.error());
    if (!camera) continue;
    Frames frames;
    EXPECT_TRUE((*camera)->start(frames.sink()));
    EXPECT_TRUE(frames.wait_for_more(10)) << device::name(format);
    (*camera)->stop();
    const std::size_t bytes =
        device::image_bytes(format, kSize, device::row_bytes(format, kSize.width));
    for (const auto& frame : frames.seen()) {
      EXPECT_GE(frame.bytes, bytes) << device::name(format);
      EXPECT_EQ(frame.flags & device::kFrameIncomplete, 0U) << device::name(format);
    }
  }
  load_vivid(1);
}

TEST(Vivid, FramesThatItDropsAreCountedAsLost) {
  auto camera = device::V4l2Camera::open(kNode, small(device::PixelFormat::kYuyv), g_clock);
  ASSERT_TRUE(camera);
  control("percentage_of_dropped_buffers=30");
  Frames frames;
  ASSERT_TRUE((*camera)->start(frames.sink()));
  ASSERT_TRUE(frames.wait_for_more(40));
  control("percentage_of_dropped_buffers=0");
  (*camera)->stop();
  const auto seen = frames.seen();
  const auto health = (*camera)->health();
  EXPECT_GT(health.lost, 0U);
  EXPECT_EQ(health.lost + seen.size(), seen.back().sequence - seen.front().sequence + 1);
  for (std::size_t i = 1; i < seen.size(); ++i)
    EXPECT_EQ((seen[i].flags & device::kFrameAfterGap) != 0,
              seen[i].sequence != seen[i - 1].sequence + 1);
  measured("%zu frames, %llu lost", seen.size(), static_cast<unsigned long long>(health.lost));
}

TEST(Vivid, BuffersThatTheDriverFlagsAreIncomplete) {
  auto camera = device::V4l2Camera::open(kNode, small(device::PixelFormat::kYuyv), g_clock);
  ASSERT_TRUE(camera);
  Frames frames;
  ASSERT_TRUE((*camera)->start(frames.sink()));
  ASSERT_TRUE(frames.wait_for_more(3));
  control("inject_v4l2_buf_flag_error=1");
  EXPECT_TRUE(wait_until([&] { return (*camera)->health().incomplete > 0; }));
  (*camera)->stop();
}

TEST(Vivid, DeliversAgainAfterADisconnect) {
  auto camera = device::V4l2Camera::open(kNode, small(device::PixelFormat::kYuyv), g_clock);
  ASSERT_TRUE(camera);
  Frames frames;
  ASSERT_TRUE((*camera)->start(frames.sink()));
  ASSERT_TRUE(frames.wait_for_more(5));
  control("disconnect=1");
  const HostTime gone = g_clock.now();
  ASSERT_TRUE(wait_until([&] { return (*camera)->health().returns == 1; }));
  ASSERT_TRUE(frames.wait_for_more(5));
  const double back_s = seconds(frames.last()->received - gone);
  (*camera)->stop();
  EXPECT_LT(back_s, seconds(kRecovery));
  measured("five frames again after %.2f s", back_s);
}

}  // namespace
}  // namespace mixrig::board

// SPDX-License-Identifier: Apache-2.0
// The composite as a camera for other programs: mixrig writes into the kernel's v4l2loopback, and
// v4l2-ctl and the project's own driver read it.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include <signal.h>

#include "hal/linux/v4l2/v4l2_camera.h"
#include "host/math/image_io/image_io.h"
#include "tests/board/bench.h"
#include "tests/support/child_process.h"

namespace mixrig::board {
namespace {

constexpr const char* kNode = "/dev/video20";
constexpr Size kSize{320, 256};
SystemClock g_clock;

/// Converts YUYV with BT.601 and 16 to 235, as readers of such nodes do; two pixels share their
/// chroma.
Image<Rgb8> rgb_of_yuyv(const std::vector<std::uint8_t>& bytes) {
  Image<Rgb8> picture(kSize);
  const auto byte = [](double value) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
  };
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const std::size_t pair = 4 * static_cast<std::size_t>((y * kSize.width + x) / 2);
      const double luma = 1.164 * (bytes[pair + (x % 2 == 0 ? 0 : 2)] - 16);
      const double u = bytes[pair + 1] - 128.0, v = bytes[pair + 3] - 128.0;
      picture.row(y)[x] = {byte(luma + 1.596 * v), byte(luma - 0.392 * u - 0.813 * v),
                           byte(luma + 2.017 * u)};
    }
  return picture;
}

/// Returns the largest mean difference of a channel, and the share of pixels that differ by more
/// than 4 among those whose neighbours in the row have the same colour: there, shared chroma loses
/// nothing.
std::pair<double, double> differences(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  double sums[3] = {};
  long flat = 0, wrong = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 1; x + 1 < a.width(); ++x) {
      const Rgb8 p = a.row(y)[x], q = b.row(y)[x];
      const int by[3] = {p.r - q.r, p.g - q.g, p.b - q.b};
      for (int c = 0; c < 3; ++c) sums[c] += by[c];
      const auto near = [&](Rgb8 other) {
        return std::max({std::abs(other.r - q.r), std::abs(other.g - q.g),
                         std::abs(other.b - q.b)}) <= 2;
      };
      if (!near(b.row(y)[x - 1]) || !near(b.row(y)[x + 1])) continue;
      ++flat;
      wrong += std::max({std::abs(by[0]), std::abs(by[1]), std::abs(by[2])}) > 4;
    }
  const double pixels = static_cast<double>(a.height()) * (a.width() - 2);
  return {std::max({std::abs(sums[0]), std::abs(sums[1]), std::abs(sums[2])}) / pixels,
          flat > 0 ? static_cast<double>(wrong) / static_cast<double>(flat) : 1};
}

class Loopback : public ::testing::Test {
 protected:
  void SetUp() override {
    if (run("insmod /host/modules/v4l2loopback.ko video_nr=20 card_label=mixrig && udevadm settle")
            .status != 0)
      GTEST_SKIP() << "no v4l2loopback.ko";
  }
  void TearDown() override { (void)run("rmmod v4l2loopback && udevadm settle"); }

  /// Reads the next picture with v4l2-ctl; false while nobody writes.
  static bool read(Image<Rgb8>& picture) {
    const Ran ran = run(std::string("timeout 10 v4l2-ctl -d ") + kNode +
                        " --stream-mmap --stream-count=1 --stream-to=/tmp/loopback.yuyv");
    std::ifstream file("/tmp/loopback.yuyv", std::ios::binary);
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
    if (ran.status != 0 || bytes.size() != 2 * kSize.area()) return false;
    picture = rgb_of_yuyv(bytes);
    return true;
  }
};

TEST_F(Loopback, TheCompositeIsACameraForOtherPrograms) {
  const std::string still = "/host/takes/still";
  Image<Rgb8> composite, seen;
  ASSERT_TRUE(image_io::read_rgb8(still + "/reference/composite/color/000002.png", composite));
  test::ChildProcess child(
      {"mixrig", "run", still + "/scene.toml", "--source", "rig:" + still + "/rig.toml", "--stream",
       std::string("v4l2://") + kNode, "--json", "/tmp/loopback.json"},
      900, "/tmp/loopback.log");
  std::pair<double, double> off{255, 1};
  EXPECT_TRUE(wait_until(
      [&] {
        if (read(seen)) off = differences(seen, composite);
        return off.second < 0.001;
      },
      60s, 300ms))
      << run("cat /tmp/loopback.log").text << run(std::string("v4l2-ctl --all -d ") + kNode).text;
  measured("mean difference %.2f of 255, %.3f %% of flat pixels off by more than 4", off.first,
           100 * off.second);
  EXPECT_LT(off.first, 2);  // a step of 8-bit chroma is 2 of 255 in blue

  auto camera = device::V4l2Camera::open(
      kNode, {.size = kSize, .format = device::PixelFormat::kYuyv, .rate_hz = 2}, g_clock);
  ASSERT_TRUE(camera) << to_line(camera.error());
  Frames frames;
  ASSERT_TRUE((*camera)->start(frames.sink()));
  EXPECT_TRUE(frames.wait_for_more(3));
  (*camera)->stop();

  child.signal(SIGINT);
  EXPECT_EQ(child.wait(), 0) << run("cat /tmp/loopback.log").text;
}

}  // namespace
}  // namespace mixrig::board

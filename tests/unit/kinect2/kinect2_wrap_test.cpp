// SPDX-License-Identifier: Apache-2.0
// A recording during which the Kinect's ticks and frame numbers, and the trigger's ticks, pass
// 2^32.
#include <array>
#include <cstdio>
#include <fstream>
#include <map>
#include <thread>

#include <gtest/gtest.h>

#include "extras/kinect2/emulated_kinect2.h"
#include "extras/kinect2/kinect2_camera.h"
#include "extras/kinect2/kinect2_depth.h"
#include "host/capture/live/session/record.h"
#include "tests/support/kinect2_answers.h"
#include "tests/support/kinect2_pictures.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/live/session_rig.h"

namespace mixrig::live {
namespace {

constexpr std::uint64_t kTurn = std::uint64_t{1} << 32;
constexpr int kFramesToWrap = 25;
constexpr std::uint32_t kTicksOfFrame = 320;  ///< of 0.125 ms: 25 Hz

std::vector<std::uint8_t> dark_frame(std::uint32_t number, std::uint32_t ticks) {
  const test::Kinect2Pictures pictures;
  std::vector<std::uint8_t> all;
  for (std::uint32_t n = 0; n < 10; ++n) {
    const auto one = test::kinect2_packet(pictures.bytes.data() + n * device::kKinect2PictureBytes,
                                          n, number, ticks);
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

class WrappedKinect2 : public Session {
 protected:
  void SetUp() override {
    Session::SetUp();
    auto opened =
        device::open_kinect2(kinect_.pipes(), "kinect2:test", clock_, device::make_kinect2_decoder);
    ASSERT_TRUE(opened) << to_line(opened.error());
    replaced_ = std::move(devices_.depth);
    devices_.depth = device::kinect2_depth_camera(*std::move(opened));
    config_.depth->trigger_line = -1;
    trigger_->number_from(kTurn - 4 * kFramesToWrap);
    session_.emplace(config_, devices_, clock_);
  }
  /// A frame of the Kinect with every fourth tick, until the recording ends.
  void crank() {
    if (!trigger_->wait_for_start(1, 20s)) return;
    for (std::uint32_t sent = 0; !done_; ++sent) {
      const std::uint32_t wraps_in = kFramesToWrap - sent;
      kinect_.send_depth(dark_frame(0U - wraps_in, 0U - kTicksOfFrame * wraps_in));
      wait([&] { return devices_.depth->health().frames > sent; });
      for (int i = 0; i < 4 && !done_; ++i) {
        tick();
        wait([&] { return session_->report().waiting_sets == 0; });
      }
    }
  }
  device::EmulatedKinect2 kinect_{test::kinect2_answers()};
  std::unique_ptr<device::DepthCamera> replaced_;  ///< which tick() still exposes
  test::TemporaryFolder folder_;
};

TEST_F(WrappedKinect2, ARecordingGoesOn) {
  RecordOptions options;
  options.out = folder_ / "take";
  options.format = take::StreamFormat::kPng;
  options.duration = 2s;
  options.least_free_bytes = 0;
  std::thread cranked([this] { crank(); });
  const std::atomic<bool> stop = false;
  const auto report = record(*session_, config_, devices_, options, stop, clock_);
  done_ = true;
  cranked.join();
  ASSERT_TRUE(report) << to_line(report.error());
  EXPECT_GT(report->frames, kFramesToWrap + 10);
  EXPECT_EQ(report->left_out, 0U);
  for (const StreamReport& stream : report->session.streams) {
    EXPECT_EQ(stream.pairing.relocks, 0U) << stream.name;
    EXPECT_EQ(stream.health.lost, 0U) << stream.name;
  }
  std::ifstream table(options.out / "ticks.csv");
  std::string line;
  std::map<std::string, std::array<std::uint64_t, 3>> last;  // by stream
  while (std::getline(table, line)) {
    unsigned long long tick = 0, counter = 0, exposed_ns = 0;
    char name[16] = {};
    if (std::sscanf(line.c_str(), "%*d,%15[^,],%llu,%llu,%llu", name, &tick, &counter,
                    &exposed_ns) != 4)
      continue;
    if (const std::string stream = name; stream != "side") {
      if (last.contains(stream)) {
        EXPECT_EQ(tick - last[stream][0], 4U) << line;
        EXPECT_EQ(counter - last[stream][1], 1U) << line;
        EXPECT_NEAR(static_cast<double>(exposed_ns - last[stream][2]), 40e6, 5e6) << line;
      }
      last[stream] = {tick, counter, exposed_ns};
    }
  }
  EXPECT_GT(last["color"][0], kTurn);
  EXPECT_GT(last["depth"][1], kTurn);
  const auto take = take::TakeReader::open(options.out);
  ASSERT_TRUE(take) << to_line(take.error());
  EXPECT_EQ(take->info().frames, report->frames);
}

}  // namespace
}  // namespace mixrig::live

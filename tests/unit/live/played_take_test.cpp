// SPDX-License-Identifier: Apache-2.0
// A recording played through devices gives bit for bit the captures that reading it gives.
#include <cstring>

#include <gtest/gtest.h>

#include "host/capture/live/session/live_source.h"
#include "host/capture/take/take_source.h"
#include "tests/support/progress.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/threaded_clock.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::live {
namespace {

using namespace std::chrono_literals;

constexpr int kFrames = 24;

template <typename T>
void expect_same_bits(const Image<T>& a, const Image<T>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (int y = 0; y < a.height(); ++y)
    EXPECT_EQ(std::memcmp(a.row(y), b.row(y), sizeof(T) * static_cast<std::size_t>(a.width())), 0)
        << what << " row " << y;
}

void expect_same(const capture::Capture& played, const capture::Capture& read) {
  EXPECT_EQ(played.number, read.number);
  EXPECT_EQ(played.tick, read.tick);
  EXPECT_EQ(played.time_s, read.time_s);
  expect_same_bits(played.plate, read.plate, "plate");
  expect_same_bits(played.depth_m, read.depth_m, "depth");
  expect_same_bits(played.amplitude, read.amplitude, "amplitude");
  EXPECT_TRUE(played.fisheye.empty() && read.fisheye.empty());
  EXPECT_EQ(played.pan_tilt.has_value(), read.pan_tilt.has_value());
  EXPECT_EQ(played.world_from_target.matrix(), read.world_from_target.matrix());
  EXPECT_EQ(played.pose_origin, read.pose_origin);
  EXPECT_EQ(played.status, read.status);
  EXPECT_EQ(played.cameras->target.pinhole, read.cameras->target.pinhole);
  EXPECT_EQ(played.cameras->target.lens.coefficients(), read.cameras->target.lens.coefficients());
  EXPECT_EQ(played.cameras->tof.pinhole, read.cameras->tof.pinhole);
  EXPECT_EQ(played.cameras->view, read.cameras->view);
  EXPECT_EQ(played.cameras->target_from_tof.matrix(), read.cameras->target_from_tof.matrix());
  EXPECT_EQ(played.cameras->depth_kind, read.cameras->depth_kind);
  EXPECT_EQ(played.cameras->noise.floor_m, read.cameras->noise.floor_m);
}

class PlayedTake : public ::testing::Test {
 protected:
  PlayedTake() {
    // Times are whole nanoseconds, as those of a recording are.
    take::TakeInfo info = take::made_info();
    info.color.rate_hz = info.depth.rate_hz = 25;
    info.depth_kind = capture::DepthKind::kDistance;
    info.depth_unit_m = 0.00025;
    info.depth_offset_m = -0.0125;
    auto writer = take::TakeWriter::create(folder_ / "take", info, take::StreamFormat::kPng);
    EXPECT_TRUE(writer) << writer.error().context;
    for (int number = 1; number <= kFrames; ++number) {
      capture::Capture frame = take::made_frame(number);
      frame.time_s = (number - 1) / 25.0;
      EXPECT_TRUE(writer->write(frame));
    }
    EXPECT_TRUE(writer->finish());
  }
  std::unique_ptr<capture::CaptureSource> read() {
    auto source = take::open_take_source(folder_ / "take");
    EXPECT_TRUE(source) << source.error().context;
    return *std::move(source);
  }
  std::unique_ptr<capture::CaptureSource> play() {
    RigConfig config;
    config.name = "a \"made\" take\n";
    config.cameras.emplace_back();
    config.cameras[0].name = "color";
    config.cameras[0].uri = "take:made/color";
    config.depth.emplace();
    config.depth->name = "depth";
    config.depth->uri = "take:made/depth";
    std::vector<Recording> recordings;
    recordings.push_back({"take:made", read()});
    auto devices = open_devices(config, DeviceOpener(clock_, std::move(recordings)));
    EXPECT_TRUE(devices) << devices.error().context;
    auto source = make_live_source(std::move(config), *std::move(devices), stop_, clock_);
    EXPECT_TRUE(source) << source.error().context;
    return *std::move(source);
  }

  test::TemporaryFolder folder_;
  test::SteppedClock clock_;
  std::atomic<bool> stop_ = false;
};

TEST_F(PlayedTake, GivesTheSameCapturesBitForBit) {
  const auto reader = read();
  const auto player = play();
  EXPECT_EQ(player->info().depth_unit_m, reader->info().depth_unit_m);
  EXPECT_EQ(player->info().rate_hz, reader->info().rate_hz);
  capture::Capture played, recorded;
  for (int number = 1; number <= kFrames; ++number, clock_.advance(40ms)) {
    SCOPED_TRACE(number);
    ASSERT_TRUE(*reader->read(number, recorded));
    const auto there = player->read(number, played);
    ASSERT_TRUE(there) << there.error().context;
    ASSERT_TRUE(*there);
    expect_same(played, recorded);
  }
  EXPECT_FALSE(*player->read(kFrames + 1, played));
}

}  // namespace
}  // namespace mixrig::live

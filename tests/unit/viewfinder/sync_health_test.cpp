// SPDX-License-Identifier: Apache-2.0
#include "host/output/viewfinder/sync_health.h"

#include <array>

#include <gtest/gtest.h>

namespace mixrig::viewfinder {
namespace {

capture::SourceReport report(std::uint64_t frames) {
  capture::SourceReport made;
  made.streams.resize(2);
  made.streams[0].name = "color", made.streams[0].uri = "v4l2:/dev/video0";
  made.streams[1].name = "depth", made.streams[1].uri = "usb:1";
  for (auto& stream : made.streams) {
    stream.health.state = device::DeviceState::kStreaming;
    stream.health.frames = frames, stream.health.lost = 2;
  }
  made.sets = frames, made.dropped_sets = 3;
  return made;
}

TEST(SyncHealthTest, RatesAreThoseBetweenTwoReports) {
  std::array<TextLine, 4> lines;
  lines[3].set("old");
  describe(report(150), report(100), 2.0, lines);
  EXPECT_EQ(lines[0].view(), "color: 25.0 frames per second, 2 lost, 0 missing");
  EXPECT_EQ(lines[1].view(), "depth: 25.0 frames per second, 2 lost, 0 missing");
  EXPECT_EQ(lines[2].view(), "frame sets: 25.0 per second, 0 incomplete, 3 dropped; 0 ticks lost");
  EXPECT_TRUE(lines[3].empty());
}

TEST(SyncHealthTest, FewerLinesThanStreamsAndNoTimeBetween) {
  std::array<TextLine, 2> lines;
  describe(report(150), {}, 0, lines);
  EXPECT_EQ(lines[0].view(), "color: 0.0 frames per second, 2 lost, 0 missing");
  EXPECT_TRUE(lines[1].view().starts_with("frame sets: 0.0 per second"));
  describe(report(1), {}, 1, {});
}

TEST(SyncHealthTest, TheCameraThatIsLostIsNamed) {
  capture::SourceReport made = report(5);
  TextLine fault;
  fault.set("old");
  describe_fault(made, fault);
  EXPECT_TRUE(fault.empty());
  made.streams[1].health.state = device::DeviceState::kLost;
  describe_fault(made, fault);
  EXPECT_EQ(fault.view(), "camera 'depth' (usb:1) is lost: check its cable and power");
  made.streams[0].health.state = device::DeviceState::kFailed;
  describe_fault(made, fault);
  EXPECT_EQ(fault.view(), "camera 'color' (v4l2:/dev/video0) has failed: run mixrig diag");
}

TEST(TextLineTest, IsCutOffAtItsEnd) {
  TextLine line;
  line.set("{:>300}", "x");
  EXPECT_EQ(line.view(), std::string(160, ' '));
}

}  // namespace
}  // namespace mixrig::viewfinder

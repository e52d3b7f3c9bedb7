// SPDX-License-Identifier: Apache-2.0
// Counters that the camera drivers share: every driver reports alike when its camera is unplugged.
#include "hal/device/stream_count.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "tests/support/progress.h"

namespace mixrig::device {
namespace {

Frame numbered(std::uint64_t sequence, std::uint32_t flags = 0) {
  return Frame{.sequence = sequence, .flags = flags};
}

TEST(StreamCount, CountsWhatIsMissingByTheDevicesCounter) {
  StreamCount count;
  Frame frame = numbered(7);
  EXPECT_TRUE(count.count(frame, true));
  EXPECT_EQ(frame.flags, 0U) << "nothing is lost before the first one";
  frame = numbered(8);
  EXPECT_TRUE(count.count(frame, true));
  EXPECT_EQ(frame.flags, 0U);
  frame = numbered(11, kFrameIncomplete);
  EXPECT_TRUE(count.count(frame, true));
  EXPECT_EQ(frame.flags, kFrameIncomplete | kFrameAfterGap);
  frame = numbered(3);  // a counter that goes back
  EXPECT_TRUE(count.count(frame, true));
  EXPECT_EQ(count.health.frames, 4U);
  EXPECT_EQ(count.health.lost, 2U);
  EXPECT_EQ(count.health.incomplete, 1U);
}

/// What a GigE Vision 1 camera and a counter of 32 bits send at their ends.
TEST(StreamCount, ACounterThatWrapsGoesOn) {
  struct Row {
    std::uint64_t before, after, period;
  };
  for (const Row& row : {Row{0xFFFE, 1, 0xFFFF}, Row{0xFFFFFFFE, 0, 1ULL << 32}}) {
    StreamCount count;
    Frame frame;
    std::uint64_t wanted = row.before;
    for (const std::uint64_t raw :
         {row.before, row.before + 1, row.after, row.after + 1, row.after + 5}) {
      frame.sequence = raw, frame.flags = kFrameOk;
      EXPECT_TRUE(count.count(frame, true));
      if (raw == row.after + 5) wanted += 3;
      EXPECT_EQ(frame.sequence, wanted++);
      EXPECT_EQ((frame.flags & kFrameAfterGap) != 0, raw == row.after + 5) << raw;
    }
    EXPECT_EQ(count.health.lost, 3U);
    EXPECT_EQ(frame.sequence, row.period + row.after + 5);
  }
}

TEST(CounterLine, ALateFrameAndARestartAreNoWrap) {
  CounterLine line;
  EXPECT_EQ(line.at(0xFFFF), 0xFFFFU);
  EXPECT_EQ(line.at(2), 0x10001U);
  EXPECT_EQ(line.at(0xFFFF), 0xFFFFU) << "it came late";
  EXPECT_EQ(line.at(3), 0x10002U);
  CounterLine restarts;
  EXPECT_EQ(restarts.at(30'000), 30'000U);
  EXPECT_EQ(restarts.at(0), 0U);
  EXPECT_EQ(restarts.at(70'000), 70'000U) << "of more than 16 bits";
  EXPECT_EQ(restarts.at(1), 1U);
}

TEST(StreamCount, AFrameWithoutABufferIsAnOverrunAndNotLostToo) {
  StreamCount count;
  Frame frame = numbered(1);
  EXPECT_FALSE(count.count(frame, false));
  frame = numbered(2);
  EXPECT_TRUE(count.count(frame, true));
  EXPECT_EQ(count.health.overrun, 1U);
  EXPECT_EQ(count.health.lost, 0U);
  EXPECT_EQ(count.health.frames, 1U);
}

TEST(StreamCount, TheFirstFrameOfACameraThatCameBackIsFlagged) {
  StreamCount count;
  Frame frame = numbered(100);
  count.count(frame, true);
  count.health.state = DeviceState::kLost;
  count.come_back();
  EXPECT_EQ(count.health.state, DeviceState::kStreaming);
  EXPECT_EQ(count.health.returns, 1U);
  frame = numbered(400);
  EXPECT_FALSE(count.count(frame, false));
  frame = numbered(401);
  EXPECT_TRUE(count.count(frame, true));
  EXPECT_EQ(frame.flags, kFrameRestarted) << "the first that is published";
  frame = numbered(402);
  count.count(frame, true);
  EXPECT_EQ(frame.flags, 0U);
  EXPECT_EQ(count.health.lost, 0U);
}

TEST(DriverThread, LooksForACameraUntilItIsThere) {
  SystemClock clock;
  DriverThread thread(clock);
  EXPECT_FALSE(thread.runs());
  EXPECT_FALSE(thread.stop());
  std::atomic<int> tries = 0;
  std::atomic<bool> found = false;
  thread.start([&] {
    found = thread.find_again("test", "test:1", [&] { return ++tries == 2; });
    while (!thread.stopping()) std::this_thread::yield();
  });
  EXPECT_TRUE(thread.runs());
  EXPECT_TRUE(test::comes_true([&] { return found.load(); }));
  EXPECT_TRUE(thread.stop());
  EXPECT_FALSE(thread.runs());
  EXPECT_EQ(tries, 2);
}

TEST(DriverThread, StopsWhileItLooksForACameraThatDoesNotComeBack) {
  SystemClock clock;
  DriverThread thread(clock);
  std::atomic<int> tries = 0;
  std::atomic<bool> found = true;
  thread.start([&] { found = thread.find_again("test", "test:1", [&] { return ++tries < 0; }); });
  EXPECT_TRUE(test::comes_true([&] { return tries > 0; }));
  EXPECT_TRUE(thread.stop());
  EXPECT_FALSE(found);
}

}  // namespace
}  // namespace mixrig::device

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

// SPDX-License-Identifier: Apache-2.0
#include "hal/base/bounded_queue.h"

#include <memory>
#include <thread>

#include <gtest/gtest.h>

namespace mixrig {
namespace {

using namespace std::chrono_literals;

TEST(BoundedQueue, DropsTheOldestWhenFullAndCounts) {
  BoundedQueue<int, 2> queue;
  for (int i = 1; i <= 5; ++i) queue.push(i);
  EXPECT_EQ(queue.dropped(), 3U);
  EXPECT_EQ(queue.pop(0ms), 4);
  EXPECT_EQ(queue.pop(0ms), 5);
  EXPECT_FALSE(queue.pop(0ms));
}

TEST(BoundedQueue, KeepsNoReferenceAfterPopping) {
  BoundedQueue<std::shared_ptr<int>, 2> queue;
  auto item = std::make_shared<int>(1);
  queue.push(item);
  queue.pop(0ms);
  EXPECT_EQ(item.use_count(), 1);
}

TEST(BoundedQueue, ClosingWakesTheConsumerAndKeepsQueuedItems) {
  BoundedQueue<int, 2> queue;
  queue.push(7);
  queue.close();
  EXPECT_EQ(queue.pop(10s), 7);
  EXPECT_FALSE(queue.pop(10s)) << "at once, not after ten seconds";
  queue.open();
  std::thread other([&] { queue.push(8); });
  EXPECT_EQ(queue.pop(10s), 8);
  other.join();
}

TEST(BoundedQueue, HandOverKeepsEveryItemAndLeavesOneBetweenTheThreads) {
  BoundedQueue<int, 2> queue;
  std::thread producer([&] {
    for (int i = 1; i <= 1000; ++i) EXPECT_TRUE(queue.hand_over(i));
    queue.close();
  });
  for (int i = 1; i <= 1000; ++i) {
    EXPECT_LE(queue.size(), 1U);
    EXPECT_EQ(queue.pop(), i);
  }
  EXPECT_FALSE(queue.pop());
  producer.join();
  EXPECT_EQ(queue.dropped(), 0U);
}

TEST(BoundedQueue, CloseEndsAWaitingHandOver) {
  BoundedQueue<int, 2> queue;
  queue.push(1);
  std::thread producer([&] { EXPECT_FALSE(queue.hand_over(2)) << "it waits for an empty queue"; });
  queue.close();
  producer.join();
  EXPECT_EQ(queue.pop(), 1) << "what was queued before is still delivered";
  EXPECT_FALSE(queue.pop());
}

}  // namespace
}  // namespace mixrig

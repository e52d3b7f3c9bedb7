// SPDX-License-Identifier: Apache-2.0
#include "host/rig/bounded_queue.h"

#include <memory>
#include <thread>

#include <gtest/gtest.h>

namespace mixrig::rig {
namespace {

using namespace std::chrono_literals;

TEST(BoundedQueue, ForgetsItsOldestWhenFullAndCounts) {
  BoundedQueue<int, 2> queue;
  for (int i = 1; i <= 5; ++i) queue.push(i);
  EXPECT_EQ(queue.dropped(), 3U);
  EXPECT_EQ(queue.pop(0ms), 4);
  EXPECT_EQ(queue.pop(0ms), 5);
  EXPECT_FALSE(queue.pop(0ms));
}

TEST(BoundedQueue, HoldsNothingBackAfterPopping) {
  BoundedQueue<std::shared_ptr<int>, 2> queue;
  auto item = std::make_shared<int>(1);
  queue.push(item);
  queue.pop(0ms);
  EXPECT_EQ(item.use_count(), 1);
}

TEST(BoundedQueue, ClosingWakesWhoWaitsAndDrainsWhatIsThere) {
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

}  // namespace
}  // namespace mixrig::rig

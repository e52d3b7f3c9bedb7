// SPDX-License-Identifier: Apache-2.0
#include "hal/base/pool.h"

#include <thread>

#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"

namespace mixrig {
namespace {

TEST(Pool, HandsOutAnObjectAgainOnlyAfterItsLastReferenceIsDropped) {
  Pool<std::vector<int>> pool;
  auto first = pool.take();
  first->assign(100, 7);
  const std::vector<int>* address = first.get();
  const std::shared_ptr<const std::vector<int>> copy = first;
  first.reset();
  EXPECT_NE(pool.take().get(), address) << "the copy still holds it";
  EXPECT_EQ(copy->size(), 100U);
}

TEST(Pool, KeepsBuffersAndAllocatesNothingOnceItIsWarm) {
  Pool<std::vector<int>> pool;
  pool.take()->assign(100, 7);
  const long before = test::allocations;
  for (int i = 0; i < 1000; ++i) {
    const auto item = pool.take();
    EXPECT_EQ(item->capacity(), 100U);
    item->assign(100, i);
  }
  EXPECT_EQ(test::allocations, before);
  EXPECT_EQ(pool.size(), 1U);
}

TEST(Pool, ObjectsOutliveIt) {
  std::shared_ptr<int> item;
  {
    Pool<int> pool;
    item = pool.take();
    *item = 5;
  }
  EXPECT_EQ(*item, 5);
}

TEST(Pool, ReferencesMayBeDroppedOnOtherThreads) {
  Pool<std::vector<int>> pool;
  for (int i = 0; i < 200; ++i) {
    auto item = pool.take();
    item->assign(10, i);
    std::thread([held = std::move(item)]() mutable { held.reset(); }).join();
  }
  EXPECT_EQ(pool.size(), 1U);
}

}  // namespace
}  // namespace mixrig

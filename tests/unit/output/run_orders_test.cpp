// SPDX-License-Identifier: Apache-2.0
#include "host/output/sink/run_orders.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig::output {
namespace {

class RunOrdersTest : public ::testing::Test {
 protected:
  std::atomic<bool> stop_ = false;
  RunOrders orders_{stop_};
};

TEST_F(RunOrdersTest, EachKindIsTakenByItselfTheOldestFirst) {
  ASSERT_TRUE(orders_.give(FocusAt{{1, 2}}));
  ASSERT_TRUE(orders_.give(PlaceObject{3, {4, 5}}));
  ASSERT_TRUE(orders_.give(FocusAt{{6, 7}}));
  EXPECT_FALSE(orders_.take<Record>());
  EXPECT_EQ(orders_.take<PlaceObject>()->object, 3);
  EXPECT_FALSE(orders_.waits<PlaceObject>());
  EXPECT_TRUE(orders_.waits<FocusAt>());
  EXPECT_EQ(orders_.take<FocusAt>()->pixel, glm::ivec2(1, 2));
  EXPECT_EQ(orders_.take<FocusAt>()->pixel, glm::ivec2(6, 7));
  EXPECT_FALSE(orders_.take<FocusAt>());
}

TEST_F(RunOrdersTest, WhatNeedsNoFrameIsInForceAtOnce) {
  ASSERT_TRUE(orders_.give(ShowView{View::kDepth}));
  ASSERT_TRUE(orders_.give(FreezePictures{true}));
  EXPECT_EQ(orders_.state().view, View::kDepth);
  EXPECT_TRUE(orders_.state().frozen);
  EXPECT_FALSE(orders_.waits<ShowView>());
  EXPECT_FALSE(stop_);
  ASSERT_TRUE(orders_.give(StopRun{}));
  EXPECT_TRUE(stop_);
}

TEST_F(RunOrdersTest, TheStateHasWhatWaitsUntilTheRunTellsOtherwise) {
  orders_.tell([](RunState& run) { run.recording = false, run.records_takes = true; });
  ASSERT_TRUE(orders_.give(Record{true}));
  EXPECT_TRUE(orders_.state().recording) << "it waits";
  orders_.tell([](RunState& run) { run.recording = false; });  // of the frame before
  EXPECT_TRUE(orders_.state().recording);
  EXPECT_TRUE(orders_.take<Record>()->on);
  EXPECT_TRUE(orders_.state().recording) << "it is about to be obeyed";
  orders_.tell([](RunState& run) { run.recording = false; });  // it failed
  EXPECT_FALSE(orders_.state().recording);
  ASSERT_TRUE(orders_.give(LearnRoom{true}));
  ASSERT_TRUE(orders_.give(FocusAt{{8, 9}}));
  EXPECT_EQ(orders_.state().scan_left, kScanLooks);
  EXPECT_EQ(orders_.state().focus_px, glm::ivec2(8, 9));
  ASSERT_TRUE(orders_.give(LearnRoom{false}));
  EXPECT_EQ(orders_.state().scan_left, 0);
}

TEST_F(RunOrdersTest, WhatDoesNotFitIsRefusedInOneLineAndTheOthersStay) {
  for (std::size_t i = 0; i < RunOrders::kMost; ++i)
    ASSERT_TRUE(orders_.give(PlaceObject{static_cast<int>(i), {}}));
  const auto refused = orders_.give(LearnChanges{});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kData);
  EXPECT_NE(refused.error().context.find("wait for a frame"), std::string::npos);
  EXPECT_TRUE(orders_.give(ShowView{View::kKey})) << "it does not wait";
  for (std::size_t i = 0; i < RunOrders::kMost; ++i)
    EXPECT_EQ(orders_.take<PlaceObject>()->object, static_cast<int>(i));
  EXPECT_TRUE(orders_.give(LearnChanges{}));
}

TEST_F(RunOrdersTest, ASignalIsOneOrderHoweverOftenItCame) {
  EXPECT_FALSE(orders_.take<LearnChanges>());
  orders_.learn_by_signal();
  orders_.learn_by_signal();
  EXPECT_TRUE(orders_.take<LearnChanges>());
  EXPECT_FALSE(orders_.take<LearnChanges>());
}

TEST_F(RunOrdersTest, OrdersOfSeveralThreadsAreEachTakenOnce) {
  constexpr int kOrders = 1000, kThreads = 3;
  std::atomic<int> running = kThreads;
  std::vector<std::thread> givers;
  for (int t = 0; t < kThreads; ++t)
    givers.emplace_back([&, t] {
      for (int i = 0; i < kOrders; ++i)
        while (!orders_.give(PlaceObject{t, {i, 0}})) std::this_thread::yield();
      --running;
    });
  std::array<int, kThreads> next{};
  const auto take_all = [&] {
    while (const auto order = orders_.take<PlaceObject>())
      EXPECT_EQ(order->pixel.x, next.at(static_cast<std::size_t>(order->object))++);
  };
  while (running > 0) take_all();
  for (std::thread& giver : givers) giver.join();
  take_all();
  for (const int taken : next) EXPECT_EQ(taken, kOrders);
}

}  // namespace
}  // namespace mixrig::output

// SPDX-License-Identifier: Apache-2.0
// The contract of TriggerInput.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/device/trigger_input.h"

namespace mixrig::test {

/// A line under test and a function that produces `count` edges, which have been delivered when
/// pull() returns.
struct TriggerInputUnderTest {
  std::unique_ptr<device::TriggerInput> input;
  std::function<void(int count)> pull;
  std::shared_ptr<void> keep{};  ///< what must outlive the line
};

struct TriggerInputMaker {
  std::string name;
  std::function<TriggerInputUnderTest()> make;
  friend void PrintTo(const TriggerInputMaker& maker, std::ostream* out) { *out << maker.name; }
};

class TriggerInputContract : public ::testing::TestWithParam<TriggerInputMaker> {
 protected:
  void SetUp() override {
    under_test_ = GetParam().make();
    ASSERT_TRUE(under_test_.input) << GetParam().name << " cannot be opened";
  }
  void TearDown() override { under_test_.input.reset(); }
  device::TriggerInput& input() { return *under_test_.input; }
  device::EdgeSink collect() {
    return [this](const device::LineEdge& edge) {
      const std::lock_guard lock(mutex_);
      edges_.push_back(edge);
    };
  }
  std::size_t count() {
    const std::lock_guard lock(mutex_);
    return edges_.size();
  }
  TriggerInputUnderTest under_test_;
  std::mutex mutex_;
  std::vector<device::LineEdge> edges_;
};

TEST_P(TriggerInputContract, EveryRisingEdgeOnceInOrder) {
  EXPECT_EQ(input().health().state, device::DeviceState::kStopped);
  ASSERT_TRUE(input().start(collect()));
  EXPECT_EQ(input().health().state, device::DeviceState::kStreaming);
  under_test_.pull(5);
  input().stop();
  ASSERT_EQ(edges_.size(), 5U);
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    EXPECT_EQ(edges_[i].sequence, i);
    if (i == 0) continue;
    EXPECT_GT(edges_[i].at, edges_[i - 1].at);
  }
  EXPECT_EQ(input().health().frames, 5U);
}

TEST_P(TriggerInputContract, DeliversNothingAfterStopAndCountsFromZeroAfterStart) {
  ASSERT_TRUE(input().start(collect()));
  under_test_.pull(2);
  input().stop();
  input().stop();  // has no effect
  under_test_.pull(1);
  EXPECT_EQ(count(), 2U);
  EXPECT_EQ(input().health().state, device::DeviceState::kStopped);
  ASSERT_TRUE(input().start(collect()));
  under_test_.pull(1);
  input().stop();
  ASSERT_EQ(edges_.size(), 3U);
  EXPECT_EQ(edges_[2].sequence, 0U);
}

TEST_P(TriggerInputContract, RefusesASecondStart) {
  ASSERT_TRUE(input().start(collect()));
  const auto again = input().start(collect());
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kUsage);
  input().stop();
}

}  // namespace mixrig::test

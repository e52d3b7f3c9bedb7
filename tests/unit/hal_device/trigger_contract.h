// SPDX-License-Identifier: Apache-2.0
// The contract of TriggerMaster. A test instantiates it with its own makers.
#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/device/trigger.h"

namespace mixrig::test {

struct TriggerUnderTest {
  std::shared_ptr<void> keep;  ///< what must outlive the trigger
  std::unique_ptr<device::TriggerMaster> trigger;
  std::function<void()> tick = [] {};  ///< produces a tick where time does not pass by itself
};

struct TriggerMaker {
  std::string name;
  std::function<TriggerUnderTest()> make;
  friend void PrintTo(const TriggerMaker& maker, std::ostream* out) { *out << maker.name; }
};

class TriggerContract : public ::testing::TestWithParam<TriggerMaker> {
 protected:
  static constexpr std::chrono::milliseconds kMs{1};

  void SetUp() override {
    under_test_ = GetParam().make();
    ASSERT_TRUE(under_test_.trigger) << GetParam().name;
  }
  device::TriggerMaster& trigger() { return *under_test_.trigger; }
  /// Reads at least `count` ticks; fewer only where no more arrive.
  std::vector<device::TriggerTick> listen(std::size_t count) {
    std::vector<device::TriggerTick> all;
    std::array<device::TriggerTick, 8> some;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (all.size() < count && std::chrono::steady_clock::now() < end) {
      under_test_.tick();
      const auto n = trigger().read_ticks(some, 20 * kMs);
      EXPECT_TRUE(n) << to_line(n.error());
      if (!n) break;
      all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(*n));
    }
    return all;
  }
  void set_two() {
    ASSERT_TRUE(trigger().configure(0, {2, {}, kMs, false}));
    ASSERT_TRUE(trigger().configure(1, {3, 12 * kMs, 3 * kMs, true}));
  }

 private:
  TriggerUnderTest under_test_;
};

TEST_P(TriggerContract, InfoIsComplete) {
  const device::TriggerInfo& info = trigger().info();
  EXPECT_FALSE(info.uri.empty());
  EXPECT_FALSE(info.version.empty());
  EXPECT_FALSE(info.clock.empty());
  EXPECT_GE(info.channels, 2);
  EXPECT_GE(info.max_divider, 100);
  EXPECT_EQ(info.tick, 10 * kMs);
  EXPECT_GT(info.slot, Duration{0});
  EXPECT_LE(info.slot, kMs);
}

TEST_P(TriggerContract, RefusesPulsesThatItCannotProduce) {
  const device::TriggerInfo& info = trigger().info();
  const auto part = info.slot / 2;
  for (const auto& [index, channel] : std::vector<std::pair<int, device::TriggerChannel>>{
           {info.channels, {1, {}, kMs, false}},
           {-1, {1, {}, kMs, false}},
           {0, {info.max_divider + 1, {}, kMs, false}},
           {0, {-1, {}, kMs, false}},
           {0, {1, {}, {}, false}},
           {0, {1, {}, -kMs, false}},
           {0, {1, -kMs, kMs, false}},
           {0, {1, {}, kMs + part, false}},
           {0, {1, part, kMs, false}},
           {0, {1, 5 * kMs, 5 * kMs, false}},
           {0, {1, Duration::max() / info.slot * info.slot, kMs, false}},
           {0, {4, {}, 40 * kMs, false}}}) {
    const auto done = trigger().configure(index, channel);
    ASSERT_FALSE(done) << index << " " << channel.divider;
    EXPECT_EQ(done.error().code, ErrorCode::kUsage) << done.error().context;
  }
  EXPECT_EQ(trigger().status()->enabled, 0U);
}

TEST_P(TriggerContract, TicksCountFromZeroAndListTheChannelsThatBeginInThem) {
  ASSERT_NO_FATAL_FAILURE(set_two());
  ASSERT_TRUE(trigger().start());
  const auto ticks = listen(20);
  ASSERT_TRUE(trigger().stop());
  ASSERT_GE(ticks.size(), 20U);
  EXPECT_EQ(ticks[0].tick, 0U);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const unsigned wanted = (ticks[i].tick % 2 == 0 ? 1U : 0U) | (ticks[i].tick % 3 == 1 ? 2U : 0U);
    EXPECT_EQ(ticks[i].channels, wanted) << ticks[i].tick;
    if (i == 0) continue;
    EXPECT_EQ(ticks[i].tick, ticks[i - 1].tick + 1);
    EXPECT_GT(ticks[i].at, ticks[i - 1].at);
  }
}

TEST_P(TriggerContract, StatusHasStateAndChannels) {
  ASSERT_NO_FATAL_FAILURE(set_two());
  auto status = trigger().status();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, device::TriggerState::kIdle);
  EXPECT_EQ(status->enabled, 3U);
  EXPECT_LE(status->asked, status->answered);
  ASSERT_TRUE(trigger().start());
  listen(3);
  status = trigger().status();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, device::TriggerState::kRunning);
  EXPECT_GE(status->tick, 2U);
  ASSERT_TRUE(trigger().stop());
  status = trigger().status();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, device::TriggerState::kIdle);
  ASSERT_TRUE(trigger().configure(1, {0, {}, {}, false}));
  EXPECT_EQ(trigger().status()->enabled, 1U);
}

TEST_P(TriggerContract, IsNotConfiguredWhileItRuns) {
  ASSERT_NO_FATAL_FAILURE(set_two());
  ASSERT_TRUE(trigger().start());
  const auto done = trigger().configure(0, {5, {}, kMs, false});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::kDevice) << done.error().context;
  EXPECT_GE(listen(2).size(), 2U);
  ASSERT_TRUE(trigger().stop());
}

TEST_P(TriggerContract, EveryStartBeginsAtTickZero) {
  ASSERT_NO_FATAL_FAILURE(set_two());
  for (int run = 0; run < 3; ++run) {
    ASSERT_TRUE(trigger().start());
    const auto ticks = listen(5);
    ASSERT_GE(ticks.size(), 5U);
    EXPECT_EQ(ticks[0].tick, 0U) << run;
    if (run == 0) {
      ASSERT_TRUE(trigger().stop());  // the other times it still runs at the next start
    }
  }
  ASSERT_TRUE(trigger().stop());
}

TEST_P(TriggerContract, ReportsNoTicksAfterStopAndMayBeStoppedTwice) {
  ASSERT_NO_FATAL_FAILURE(set_two());
  ASSERT_TRUE(trigger().stop());
  ASSERT_TRUE(trigger().start());
  listen(3);
  ASSERT_TRUE(trigger().stop());
  ASSERT_TRUE(trigger().stop());
  std::array<device::TriggerTick, 8> some;
  for (int i = 0; i < 200; ++i) {  // ticks that were sent before the stop
    if (*trigger().read_ticks(some, 20 * kMs) == 0) break;
  }
  EXPECT_EQ(*trigger().read_ticks(some, 50 * kMs), 0U);
}

TEST_P(TriggerContract, EveryFaultHasANameAndAMeaning) {
  const auto status = trigger().status();
  ASSERT_TRUE(status);
  for (const device::TriggerFault& fault : status->faults) {
    EXPECT_FALSE(fault.name.empty());
    EXPECT_GT(fault.meaning.size(), 10U) << fault.name;
  }
}

}  // namespace mixrig::test

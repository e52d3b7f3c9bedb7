// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/trigger/software_trigger.h"

#include <map>

#include <gtest/gtest.h>

#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"
#include "tests/support/throw_in.h"

namespace mixrig::device {
namespace {

using namespace std::chrono_literals;

TEST(SoftwareSchedule, EdgesAreAtTheConfiguredTimes) {
  SoftwareSchedule schedule;
  schedule.configure(0, {.divider = 4, .phase = 0ms, .width = 1ms});
  schedule.configure(1, {.divider = 4, .phase = 20ms, .width = 15ms});
  schedule.configure(5, {.divider = 10, .phase = 3ms, .width = 50ms});
  const HostTime begin(7s);
  schedule.start(begin);
  std::map<int, std::vector<Duration>> on, off;
  HostTime last = begin;
  std::uint64_t ticks = 0;
  while (ticks < 1000) {
    const auto edge = schedule.next();
    ASSERT_GE(edge.at, last);
    last = edge.at;
    if (edge.channel < 0) {
      ASSERT_EQ(edge.tick, ticks);
      ASSERT_EQ(edge.at, begin + static_cast<long>(ticks++) * 10ms);
      continue;
    }
    (edge.active ? on : off)[edge.channel].push_back(edge.at - begin);
  }
  EXPECT_EQ(on[0].size(), 250U);
  EXPECT_EQ(on[5].size(), 100U);
  for (std::size_t i = 0; i + 1 < on[0].size(); ++i) {
    EXPECT_EQ(on[0][i], static_cast<long>(i) * 40ms);
    EXPECT_EQ(off[0][i] - on[0][i], 1ms);
    EXPECT_EQ(on[1][i], static_cast<long>(i) * 40ms + 20ms);
    EXPECT_EQ(off[1][i] - on[1][i], 15ms);
  }
  EXPECT_EQ(on[2].size(), 0U);
}

TEST(SoftwareSchedule, FiredMaskHasTheChannelsOfEveryTick) {
  SoftwareSchedule schedule;
  schedule.configure(0, {.divider = 4, .width = 1ms});
  schedule.configure(1, {.divider = 5, .phase = 25ms, .width = 1ms});
  for (std::uint64_t tick = 0; tick < 100; ++tick)
    EXPECT_EQ(schedule.fired(tick), (tick % 4 == 0 ? 1U : 0U) | (tick % 5 == 2 ? 2U : 0U)) << tick;
}

class NoLines final : public LineOutputs {
 public:
  int count() const override { return 1; }
  Result<void> drive(int, bool) override { return {}; }
};

TEST(SoftwareTrigger, WhatItsThreadThrowsStopsItAndItCanBeStartedAgain) {
  test::ThreadedClock clock;
  SoftwareTrigger trigger(std::make_unique<NoLines>(), clock, "lines");
  {
    const test::ThrowIn thrown("trigger");
    ASSERT_TRUE(trigger.start());
    EXPECT_TRUE(test::comes_true([&] { return trigger.status()->state == TriggerState::kIdle; }));
  }
  ASSERT_TRUE(trigger.start());
  EXPECT_EQ(trigger.status()->state, TriggerState::kRunning);
  EXPECT_TRUE(trigger.stop());
}

}  // namespace
}  // namespace mixrig::device

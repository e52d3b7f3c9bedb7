// SPDX-License-Identifier: Apache-2.0
#include "hal/base/clock.h"

#include <type_traits>

#include <gtest/gtest.h>

namespace mixrig {
namespace {

template <typename A, typename B>
concept Subtractable = requires(A a, B b) {
  a - b;
};

static_assert(Subtractable<HostTime, HostTime>);
static_assert(!Subtractable<HostTime, McuTime>, "clock domains must not mix");
static_assert(!std::is_convertible_v<DeviceTime, HostTime>);

TEST(ManualClock, MovesOnlyWhenTold) {
  ManualClock clock;
  const HostTime start = clock.now();
  EXPECT_EQ(clock.now(), start);
  clock.advance(std::chrono::milliseconds(10));
  EXPECT_EQ(milliseconds(clock.now() - start), 10.0);
  clock.sleep_until(start);  // the past: no way back
  EXPECT_EQ(milliseconds(clock.now() - start), 10.0);
  clock.sleep_until(start + std::chrono::seconds(1));
  EXPECT_EQ(seconds(clock.now() - start), 1.0);
}

TEST(SystemClock, NeverRunsBackwards) {
  const SystemClock clock;
  HostTime last = clock.now();
  for (int i = 0; i < 1000; ++i) {
    const HostTime now = clock.now();
    ASSERT_GE(now, last);
    last = now;
  }
}

}  // namespace
}  // namespace mixrig

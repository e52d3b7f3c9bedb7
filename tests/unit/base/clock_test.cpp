// SPDX-License-Identifier: Apache-2.0
#include "hal/base/clock.h"

#include <type_traits>

#include <gtest/gtest.h>

#include "tests/support/threaded_clock.h"

namespace mixrig {
namespace {

template <typename A, typename B>
concept Subtractable = requires(A a, B b) {
  a - b;
};

static_assert(Subtractable<HostTime, HostTime>);
static_assert(!Subtractable<HostTime, McuTime>, "clock domains must not mix");
static_assert(!std::is_convertible_v<DeviceTime, HostTime>);

TEST(ManualClock, MovesOnlyByAdvanceAndSleep) {
  ManualClock clock;
  const HostTime start = clock.now();
  EXPECT_EQ(clock.now(), start);
  clock.advance(std::chrono::milliseconds(10));
  EXPECT_EQ(milliseconds(clock.now() - start), 10.0);
  clock.sleep_until(start);  // the past: no effect
  EXPECT_EQ(milliseconds(clock.now() - start), 10.0);
  clock.sleep_until(start + std::chrono::seconds(1));
  EXPECT_EQ(seconds(clock.now() - start), 1.0);
}

/// The contract of every Clock.
template <typename C>
class ClockContract : public ::testing::Test {
 protected:
  C clock_;
};
using Clocks = ::testing::Types<SystemClock, ManualClock, test::ThreadedClock>;
TYPED_TEST_SUITE(ClockContract, Clocks);

TYPED_TEST(ClockContract, NeverRunsBackwards) {
  HostTime last = this->clock_.now();
  for (int i = 0; i < 1000; ++i) {
    const HostTime now = this->clock_.now();
    ASSERT_GE(now, last);
    last = now;
  }
}

TYPED_TEST(ClockContract, SleepsUntilTheGivenTimeAndNotForAPastOne) {
  const HostTime start = this->clock_.now();
  const HostTime until = start + std::chrono::milliseconds(2);
  this->clock_.sleep_until(until);
  EXPECT_GE(this->clock_.now(), until);
  this->clock_.sleep_until(start);
  EXPECT_GE(this->clock_.now(), until);
}

}  // namespace
}  // namespace mixrig

// SPDX-License-Identifier: Apache-2.0
#include "host/output/viewfinder/rate_meter.h"

#include <gtest/gtest.h>

namespace mixrig::viewfinder {
namespace {

using namespace std::chrono_literals;

TEST(RateMeterTest, IsThatOfTheLastSecondAndNothingWithoutTwoEvents) {
  RateMeter meter;
  HostTime now{10s};
  EXPECT_EQ(meter.rate_hz(now), 0);
  meter.add(now);
  EXPECT_EQ(meter.rate_hz(now), 0);
  for (int i = 0; i < 300; ++i) meter.add(now += 40ms);
  EXPECT_NEAR(meter.rate_hz(now), 25, 1e-9);
  EXPECT_NEAR(meter.rate_hz(now + 500ms), 25, 1e-9);
  EXPECT_EQ(meter.rate_hz(now + 2s), 0) << "nothing comes any longer";
  for (int i = 0; i < 300; ++i) meter.add(now += 4ms);
  EXPECT_NEAR(meter.rate_hz(now), 250, 1e-9) << "more than it remembers of a second";
}

}  // namespace
}  // namespace mixrig::viewfinder

// SPDX-License-Identifier: Apache-2.0
// Arrival times without their jitter, against the times at which packets were sent.
#include "extras/broadcast/poses/arrival_comb.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::pose {
namespace {

struct CombWorst {
  double first_s = 0, settled_s = 0;  ///< error of the first second, and after it
};

/// Packets of `rate_hz` (1 + drift) that come up to `jitter_s` late, `loss` of them never.
CombWorst worst_of(double rate_hz, double said_hz, double jitter_s, double loss, double drift) {
  ArrivalComb comb(said_hz);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share;
  CombWorst worst;
  HostTime last{};
  for (int i = 0; i < 20 * rate_hz; ++i) {
    const double sent_s = 7.3 + i / (rate_hz * (1 + drift));
    if (share(random) < loss) continue;
    const HostTime came(Duration(std::llround(1e9 * (sent_s + jitter_s * share(random)))));
    const HostTime due = comb.due(came);
    EXPECT_LE(due, came);
    EXPECT_GE(due, last);
    last = due;
    const double error_s = std::abs(seconds(due.time_since_epoch()) - sent_s);
    (i < rate_hz ? worst.first_s : worst.settled_s) =
        std::max(i < rate_hz ? worst.first_s : worst.settled_s, error_s);
  }
  return worst;
}

TEST(ArrivalComb, TakesOutJitterAndLossOfAnyRate) {
  for (const double rate_hz : {24.0, 50.0, 59.94, 100.0}) {
    const double jitter_s = 0.4 / rate_hz;
    const CombWorst worst = worst_of(rate_hz, rate_hz, jitter_s, 0.1, 0);
    // The earliest of about 58 packets is late by jitter / 58 in the mean, seldom by five times it.
    EXPECT_LT(worst.settled_s, 0.1 * jitter_s) << rate_hz;
    EXPECT_LT(worst.first_s, jitter_s) << rate_hz;
  }
}

TEST(ArrivalComb, FollowsAClockThatDrifts) {
  for (const double drift : {-2e-4, 2e-4})
    // 64 packets take 1.3 s, in which the phase moves by 0.26 ms.
    EXPECT_LT(worst_of(50, 50, 0.004, 0, drift).settled_s, 0.0009) << drift;
}

TEST(ArrivalComb, ExactTimesStayExact) { EXPECT_LT(worst_of(25, 25, 0, 0, 0).settled_s, 1e-8); }

TEST(ArrivalComb, AnotherRateIsToldAndArrivalsStay) {
  ArrivalComb comb(50);
  for (int i = 0; i < 200; ++i) {
    const HostTime came(Duration(std::llround(1e9 * i / 60.0)));
    const HostTime due = comb.due(came);
    if (i > 100) {
      EXPECT_EQ(due, came);
    }
  }
  EXPECT_FALSE(comb.fits());
}

TEST(ArrivalComb, KnowsTheJitter) {
  ArrivalComb comb(50);
  EXPECT_EQ(comb.jitter().count(), 0);
  for (int i = 0; i < 64; ++i)
    (void)comb.due(HostTime(Duration(20'000'000LL * i + (i % 2) * 4'000'000)));
  EXPECT_NEAR(seconds(comb.jitter()), 0.004 / std::sqrt(2), 1e-6);
}

}  // namespace
}  // namespace mixrig::pose

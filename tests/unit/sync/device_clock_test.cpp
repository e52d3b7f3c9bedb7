// SPDX-License-Identifier: Apache-2.0
#include "host/capture/sync/device_clock.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::sync {
namespace {

using namespace std::chrono_literals;

struct Link {
  double drift_ppm = 0;
  double least_delay_s = 0.003;
  double jitter_s = 0;       // mean of an exponential delay
  double outlier_share = 0;  // share of frames that are up to 200 ms late
};

class Camera {
 public:
  explicit Camera(Link link) : link_(link) {}
  // The frame of true host time t, and when it arrives.
  DeviceTime stamp(double t) const {
    return DeviceTime(Duration(std::llround((t - 77.0) / (1 + link_.drift_ppm * 1e-6) * 1e9)));
  }
  HostTime arrival(double t) {
    double delay = link_.least_delay_s;
    if (link_.jitter_s > 0) delay += std::exponential_distribution<>(1 / link_.jitter_s)(random_);
    if (roll_(random_) < link_.outlier_share) delay += 0.2 * roll_(random_);
    return HostTime(Duration(std::llround((t + delay) * 1e9)));
  }

 private:
  Link link_;
  std::mt19937_64 random_{9};
  std::uniform_real_distribution<> roll_{0, 1};
};

double error_ms(const DeviceClock& clock, const Camera& camera, double t, double least_delay_s) {
  return (seconds(clock.to_host(camera.stamp(t))->time_since_epoch()) - t - least_delay_s) * 1e3;
}

TEST(DeviceClock, LearnsDriftOfARealClockWithinAFewPpm) {
  for (const double drift : {0.0, 390.0, -390.0, 1500.0}) {
    Camera camera({.drift_ppm = drift, .jitter_s = 0.005, .outlier_share = 0.05});
    DeviceClock clock;
    for (int i = 0; i < 25 * 120; ++i)
      ASSERT_EQ(clock.add(camera.stamp(100 + i * 0.04), camera.arrival(100 + i * 0.04)),
                DeviceClock::Verdict::kOk);
    EXPECT_NEAR(clock.drift_ppm(), drift, 5) << drift;
    // Against the truth; the least delay is approached from above.
    EXPECT_GT(error_ms(clock, camera, 220, 0.003), -0.2) << drift;
    EXPECT_LT(error_ms(clock, camera, 220, 0.003), 0.4) << drift;
  }
}

TEST(DeviceClock, IsUsableFromTheFirstFrameAndBetterSoon) {
  Camera camera({.drift_ppm = 390, .jitter_s = 0.002});
  DeviceClock clock;
  EXPECT_FALSE(clock.to_host(camera.stamp(100)));
  for (int i = 0; i < 1000; ++i) {
    const double t = 100 + i * 0.04;
    clock.add(camera.stamp(t), camera.arrival(t));
    if (i > 25) {
      ASSERT_LT(std::abs(error_ms(clock, camera, t, 0.003)), 5.0) << i;
    }
    if (i > 500) {
      ASSERT_LT(std::abs(error_ms(clock, camera, t, 0.003)), 1.0) << i;
    }
  }
}

/// A busy host takes the first frames late: one that came in time is enough.
TEST(DeviceClock, OfTheFirstFramesTheEarliestCounts) {
  for (int in_time = 0; in_time < 4; ++in_time) {
    Camera camera({});
    DeviceClock clock;
    for (int i = 0; i < 4; ++i) {
      const double t = 100 + i * 0.1;
      clock.add(camera.stamp(t), camera.arrival(t) + (i == in_time ? 0ms : 60ms));
      if (i >= in_time) {
        EXPECT_NEAR(error_ms(clock, camera, t, 0.003), 0, 1e-6) << i;
      }
    }
  }
}

TEST(DeviceClock, StaysTrueForSixHours) {
  Camera camera({.drift_ppm = 50, .jitter_s = 0.003});
  DeviceClock clock;
  double worst_ms = 0;
  for (long i = 0; i < 6 * 3600L * 10; ++i) {
    const double t = 100 + static_cast<double>(i) * 0.1;
    clock.add(camera.stamp(t), camera.arrival(t));
    if (i > 1000 && i % 997 == 0)
      worst_ms = std::max(worst_ms, std::abs(error_ms(clock, camera, t, 0.003)));
  }
  EXPECT_LT(worst_ms, 1.5);
  EXPECT_EQ(clock.restarts(), 0U);
}

TEST(DeviceClock, AClockThatRestartsIsDetected) {
  Camera camera({});
  DeviceClock clock;
  for (int i = 0; i < 500; ++i)
    clock.add(camera.stamp(1000 + i * 0.04), camera.arrival(1000 + i * 0.04));
  // Switched off and on: stamps begin at zero again.
  const auto verdict = clock.add(DeviceTime(5s), camera.arrival(1021));
  EXPECT_EQ(verdict, DeviceClock::Verdict::kRestarted);
  EXPECT_NEAR(seconds(clock.to_host(DeviceTime(5s))->time_since_epoch()), 1021.003, 1e-6);
}

TEST(DeviceClock, AJumpForwardsIsAcceptedAfterThreeFramesNotAfterOne) {
  Camera camera({});
  DeviceClock clock;
  for (int i = 0; i < 500; ++i)
    clock.add(camera.stamp(1000 + i * 0.04), camera.arrival(1000 + i * 0.04));
  const auto jump = [&](double t) { return clock.add(camera.stamp(t + 600), camera.arrival(t)); };
  EXPECT_EQ(jump(1020.04), DeviceClock::Verdict::kOk);
  EXPECT_EQ(clock.add(camera.stamp(1020.08), camera.arrival(1020.08)), DeviceClock::Verdict::kOk);
  EXPECT_EQ(jump(1020.12), DeviceClock::Verdict::kOk);
  EXPECT_EQ(jump(1020.16), DeviceClock::Verdict::kOk);
  EXPECT_EQ(jump(1020.20), DeviceClock::Verdict::kRestarted);
}

}  // namespace
}  // namespace mixrig::sync

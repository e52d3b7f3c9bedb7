// SPDX-License-Identifier: Apache-2.0
#include "host/judge/latency/soak_bench.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/refusal.h"

namespace mixrig::session {
namespace {

TEST(SoakReportTest, EveryFrameIsAccountedFor) {
  SoakReport report;
  report.exposed = 1000, report.before = 30, report.shown = 960;
  report.unpaired = 4, report.dropped_before = 3, report.dropped_after = 2;
  EXPECT_EQ(report.unexplained(), 1);
  EXPECT_EQ(to_json(report)["frames"]["unexplained"], 1);
  EXPECT_NE(to_table(report).find("1 unexplained"), std::string::npos);
}

TEST(SoakReportTest, DriftAndGrowthLeaveOutTheFirstQuarter) {
  SoakReport report;
  for (int i = 0; i < 12; ++i)
    report.parts.push_back({.frames = 100,
                            .p50_ms = i < 3 ? 100.0 : 10 + 0.1 * i,
                            .p99_ms = 20,
                            .most_ms = 30,
                            .resident_mb = i < 3 ? 50.0 : 100.0});
  EXPECT_NEAR(report.drift_ms(), 0.6, 1e-9);
  EXPECT_EQ(report.growth_mb(), 0);
  EXPECT_EQ(SoakReport().drift_ms(), 0);
}

TEST(FastClockTest, RunsSoManyTimesAsFast) {
  const SystemClock host;
  FastClock fast(50);
  const HostTime before_first = host.now(), begin = fast.now(), after_first = host.now();
  fast.sleep_until(begin + std::chrono::milliseconds(500));
  const HostTime before_last = host.now(), end = fast.now(), after_last = host.now();
  EXPECT_GE(end - begin, std::chrono::milliseconds(500));
  EXPECT_GE(end - begin + Duration(100), 50 * (before_last - after_first));
  EXPECT_LE(end - begin - Duration(100), 50 * (after_last - before_first)) << "rounding aside";
}

TEST(SoakTest, RefusesWhatIsNoSoak) {
  const std::atomic<bool> stop = false;
  EXPECT_TRUE(test::refused(soak({.duration_s = 0.1}, stop, {}), {}, ErrorCode::kUsage));
  EXPECT_FALSE(soak({.speed = 0.5}, stop, {}));
}

}  // namespace
}  // namespace mixrig::session

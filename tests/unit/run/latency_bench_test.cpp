// SPDX-License-Identifier: Apache-2.0
// The report of a measured delay; the estimator itself is tested in tests/unit/measure.
#include "host/judge/latency/latency_bench.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace mixrig::session {
namespace {

LatencyReport report_of_100_frames() {
  LatencyReport report;
  report.frames = 100, report.period_ms = 40;
  for (int i = 1; i <= 100; ++i) {
    const auto ms = static_cast<float>(i);
    report.wait_ms.push_back(0.2F * ms);
    report.compose_ms.push_back(0.7F * ms);
    report.show_ms.push_back(0.1F * ms);
    report.total_ms.push_back(ms);
  }
  return report;
}

TEST(LatencyReportTest, QuantilesAreThoseOfTheFramesAndP99IsInPeriodsToo) {
  const auto out = to_json(report_of_100_frames());
  EXPECT_NEAR(out["delay_ms"]["p50"].get<double>(), 50.5, 1e-4);
  EXPECT_NEAR(out["delay_ms"]["p99"].get<double>(), 99.01, 1e-4);
  EXPECT_NEAR(out["periods_p99"].get<double>(), 99.01 / 40, 1e-5);
  EXPECT_NEAR(out["stages_ms"]["compose"]["max"].get<double>(), 70, 1e-4);
  EXPECT_TRUE(out["correlated"].is_null()) << "the motions could not tell";
}

TEST(LatencyReportTest, TheMotionsStandBesideTheStamps) {
  LatencyReport report = report_of_100_frames();
  report.correlated = measure::Delay{0.0512, 0.0008, 0.998};
  EXPECT_NEAR(to_json(report)["correlated"]["delay_ms"].get<double>(), 51.2, 1e-9);
  EXPECT_NE(to_table(report).find("by the motions alone: 51.2 +- 0.8 ms"), std::string::npos);
  EXPECT_NE(to_table(report).find("p99 is 2.48 frame periods"), std::string::npos);
}

TEST(LatencyReportTest, TheBarsAreTheStages) {
  const report::BarPlot plot = plot_of(report_of_100_frames());
  ASSERT_EQ(plot.bars.size(), 2U);
  ASSERT_EQ(plot.bars[0].parts.size(), 3U);
  EXPECT_NEAR(plot.bars[0].parts[1].value, 35.35, 1e-4);
  EXPECT_NEAR(plot.bars[1].parts[0].value, 19.802, 1e-4);
}

}  // namespace
}  // namespace mixrig::session

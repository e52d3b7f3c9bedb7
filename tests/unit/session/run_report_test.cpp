// SPDX-License-Identifier: Apache-2.0
#include "host/session/run_report.h"

#include <gtest/gtest.h>

namespace mixrig::session {
namespace {

RunReport three_frames() {
  RunReport report;
  report.backend = "cpu";
  report.renderer = "cpu, 2 threads";
  report.size = {1280, 1024};
  const auto fill = [](measure::QuantileSketch& sketch, std::initializer_list<double> samples) {
    for (double sample : samples) sketch.add(sample);
  };
  fill(report.frame_ms, {10, 20, 30});
  fill(report.stage_ms[static_cast<std::size_t>(render::Stage::kWarp)], {1, 2, 9});
  fill(report.stage_ms[static_cast<std::size_t>(render::Stage::kUpload)], {0, 0, 0});
  fill(report.foreground_pct, {0, 12.5, 33.333333});
  report.rss_mb = 123;
  return report;
}

TEST(RunReport, CountsFramesASecondFromTheMeanFrame) {
  EXPECT_DOUBLE_EQ(fps(three_frames()), 50.0);
  EXPECT_DOUBLE_EQ(fps({}), 0.0);
}

TEST(RunReport, HasTheKeysOfTheContract) {
  const nlohmann::json json = to_json(three_frames());
  EXPECT_EQ(json["frames"], 3);
  EXPECT_EQ(json["size"], "1280x1024");
  EXPECT_EQ(json["frame_ms"]["p50"], 20.0);
  EXPECT_EQ(json["frame_ms"]["p95"], 29.0);
  EXPECT_EQ(json["frame_ms"]["p99"], 29.8);
  EXPECT_EQ(json["stage_ms"]["warp"]["p95"], 8.3);
  EXPECT_FALSE(json["stage_ms"].contains("upload")) << "a stage that did not run has no time";
  EXPECT_EQ(json["foreground_pct"]["mean"], 15.28);
  EXPECT_EQ(json["foreground_pct"]["p50"], 12.5);
  EXPECT_EQ(json["foreground_pct"]["max"], 33.33);
  EXPECT_FALSE(json.contains("error")) << "no truth, no error";
}

TEST(RunReport, WritesWhatCouldNotBeJudgedAsNull) {
  RunReport report = three_frames();
  report.error.emplace();
  report.error->key_iou = 0.96;
  const nlohmann::json error = to_json(report)["error"];
  EXPECT_EQ(error.size(), 9U);
  EXPECT_EQ(error["key_iou"], 0.96);
  EXPECT_TRUE(error["order_wrong_pct"].is_null());
  EXPECT_EQ(to_json(report).dump().find("nan"), std::string::npos);
  EXPECT_NE(to_table(report).find("order_wrong_pct             -"), std::string::npos);
}

TEST(RunReport, PeakMemoryIsThatOfARealProcess) {
  EXPECT_GT(peak_rss_mb(), 1.0);
  EXPECT_LT(peak_rss_mb(), 1e5);
}

}  // namespace
}  // namespace mixrig::session

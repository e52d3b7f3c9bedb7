// SPDX-License-Identifier: Apache-2.0
#include "host/run/report/run_report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hal/base/log.h"

namespace mixrig::session {
namespace {

RunReport three_frames() {
  RunReport report;
  report.compositor.backend = "cpu";
  report.compositor.renderer = "cpu, 2 threads";
  report.compositor.size = {1280, 1024};
  const auto fill = [](measure::QuantileSketch& sketch, std::initializer_list<double> samples) {
    for (double sample : samples) sketch.add(sample);
  };
  fill(report.frames.frame_ms, {10, 20, 30});
  fill(report.frames.stage_ms[static_cast<std::size_t>(render::Stage::kWarp)], {1, 2, 9});
  fill(report.frames.stage_ms[static_cast<std::size_t>(render::Stage::kUpload)], {0, 0, 0});
  fill(report.frames.foreground_pct, {0, 12.5, 33.333333});
  report.rss_mb = 123;
  return report;
}

TEST(RunReport, CountsFramesASecondFromTheMeanFrame) {
  EXPECT_DOUBLE_EQ(fps(three_frames()), 50.0);
  EXPECT_DOUBLE_EQ(fps({}), 0.0);
}

TEST(RunReport, SaysHowTheCamerasPicturesCameIn) {
  PlateReport plates{.imported = 0, .copied = 30, .layout = {}, .why_copied = "no such thing"};
  EXPECT_EQ(text(plates), "copied: no such thing");
  plates.why_copied.clear();
  EXPECT_EQ(text(plates), "copied: the camera's driver shares no buffers of samples");
  plates.imported = 30, plates.copied = 0, plates.layout = RawLayout::kYuyv;
  EXPECT_EQ(text(plates), "imported (DMABUF, yuyv)");
  plates.copied = 10, plates.why_copied = "refused";
  EXPECT_EQ(text(plates), "imported (DMABUF, yuyv), 10 of 40 copied: refused");
  RunReport report = three_frames();
  EXPECT_FALSE(to_json(report).contains("camera_pictures"));
  report.compositor.plates = plates;
  EXPECT_EQ(to_json(report)["camera_pictures"]["imported"], 30);
  EXPECT_NE(to_table(report).find("camera pictures: imported (DMABUF, yuyv)"), std::string::npos);
}

TEST(RunReport, HasWhatTheRunWarnedOf) {
  log_warning("take", "a guess that only this test makes");
  log_info("take", "nothing to warn of");
  const nlohmann::json json = to_json(three_frames());
  ASSERT_TRUE(json.contains("warnings"));
  EXPECT_EQ(json["warnings"].back(), "take: a guess that only this test makes");
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
  EXPECT_EQ(error.size(), 22U);
  EXPECT_EQ(error["key_iou"], 0.96);
  EXPECT_TRUE(error["order_wrong_pct"].is_null());
  EXPECT_TRUE(error["scraps"]["person_through_object"].is_null());
  EXPECT_TRUE(error["stairs"]["virtual_width_px"].is_null());
  EXPECT_EQ(to_json(report).dump().find("nan"), std::string::npos);
  EXPECT_NE(to_table(report).find("order_wrong_pct                  -"), std::string::npos);
}

TEST(RunReport, HasContestedPixelsAndBaselinesBesideTheErrors) {
  RunReport report = three_frames();
  report.error.emplace();
  report.error->object_rmse = 0.02;
  report.error->key_iou = 0.96;
  report.error->contested.key_iou = 0.81234;
  EXPECT_FALSE(to_json(report).contains("baselines")) << "not wanted";
  measure::Errors pasted;
  pasted.key_iou = 0.0;
  pasted.contested.key_iou = 0.125;
  report.baselines = {{measure::Baseline::kPasted, pasted}};
  const nlohmann::json json = to_json(report);
  EXPECT_EQ(json["error"]["object_rmse"], 0.02);
  EXPECT_EQ(json["error"]["contested"]["key_iou"], 0.8123);
  EXPECT_TRUE(json["error"]["contested"]["pixels_pct"].is_null());
  EXPECT_EQ(json["baselines"]["pasted"]["key_iou"], 0.0);
  EXPECT_EQ(json["baselines"]["pasted"]["contested"]["key_iou"], 0.125);
  const std::string table = to_table(report);
  EXPECT_NE(table.find("contested key_iou           0.8123      0.125\n"), std::string::npos)
      << table;
  EXPECT_NE(table.find("key_iou                       0.96          0\n"), std::string::npos);
}

TEST(RunReport, TellsWhereThePosesCameFromAndWhatWasLost) {
  RunReport report = three_frames();
  report.pose.source = "mocap";
  report.pose.when_lost = pose::WhenLost::kHide;
  report.pose.frames.frames[0] = 2;
  report.pose.frames.frames[static_cast<std::size_t>(capture::PoseLoss::kTooOld)] = 1;
  report.pose.faults.packets_lost = 7;
  report.pose.faults.clock_steps = 1;
  for (double age_ms : {1.0, 3.0}) report.pose.age_ms.add(age_ms);
  const nlohmann::json pose = to_json(report)["pose"];
  EXPECT_EQ(pose["source"], "mocap");
  EXPECT_EQ(pose["frames"], 2);
  EXPECT_EQ(pose["lost_by"], (nlohmann::json{{"too_old", 1}}));
  EXPECT_EQ(pose["stream"]["packets_lost"], 7);
  EXPECT_EQ(pose["age_ms"]["p50"], 2.0);
  const std::string table = to_table(report);
  for (const char* part : {"pose lost in 1 frames (too_old 1): virtual objects hidden",
                           "steps of their clock: 1", "pose packets: 7 lost\n"})
    EXPECT_NE(table.find(part), std::string::npos) << table;
  capture::PoseFaults& faults = report.pose.faults;
  faults.packets_late = 1, faults.packets_bad = 2, faults.packets_version = 3;
  faults.packets_foreign = 4, faults.packets_unstamped = 5, faults.refused = 6;
  EXPECT_NE(
      to_table(report).find(
          "pose packets: 7 lost, 1 late, 2 damaged or of another layout, 3 of another "
          "version, 4 of another camera, source or sender, 5 without a time stamp, 6 in which "
          "the camera's body is missing or not tracked\n"),
      std::string::npos)
      << to_table(report);
  EXPECT_EQ(to_json(report)["pose"]["stream"]["packets_foreign"], 4);
  EXPECT_TRUE(to_json(three_frames())["pose"]["age_ms"].is_null());
  EXPECT_EQ(to_table(three_frames()).find("pose"), std::string::npos) << "nothing to say";
}

TEST(RunReport, TellsTheSlipThatIsKnown) {
  RunReport report = three_frames();
  EXPECT_TRUE(to_json(report)["pose"]["slip_px"].is_null());
  EXPECT_TRUE(to_json(report)["pose"]["slip_sigma_px"].is_null());
  report.pose.slip.measured = {0.34567, 0.7, 0.9};
  report.pose.slip.sigma_px = 0.41239;
  report.pose.slip.within_95_pct = 96.5;
  const nlohmann::json pose = to_json(report)["pose"];
  EXPECT_EQ(pose["slip_px"], (nlohmann::json{{"rms", 0.3457}, {"p95", 0.7}, {"max", 0.9}}));
  EXPECT_EQ(pose["slip_sigma_px"], 0.4124);
  EXPECT_EQ(pose["within_95_pct"], 96.5);
  EXPECT_NE(to_table(report).find("slip of the contact points: measured 0.35 px RMS, at most 0.90 "
                                  "px; predicted 0.41 px RMS"),
            std::string::npos);
}

TEST(RunReport, PeakMemoryIsThatOfARealProcess) {
  EXPECT_GT(peak_rss_mb(), 1.0);
  EXPECT_LT(peak_rss_mb(), 1e5);
}

}  // namespace
}  // namespace mixrig::session

// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/judge/bench/moved_bytes.h"
#include "host/judge/bench/suite.h"

namespace mixrig::bench {
namespace {

Suite suite_of_two() {
  Row ours;
  ours.name = "ours", ours.group = "cpu", ours.times_ms = {4, 1, 3, 2, 5};
  ours.bad_pct = 2, ours.band_bad_pct = 12.5, ours.mae_mm = 40, ours.bytes = 3e6;
  ours.more = {{"key_iou", 0.95}};
  Row other;
  other.name = "library::function", other.group = "library", other.peer = true;
  other.times_ms = {200}, other.band_bad_pct = 30;
  return {"warp", "band_bad_pct", "wrong, %", {ours, other}};
}

TEST(SuiteReport, JsonHasWhatARowHasAndNothingElse) {
  const nlohmann::json rows = to_json(suite_of_two(), 1.5e9);
  ASSERT_EQ(rows.size(), 2U);
  const nlohmann::json ours = {{"name", "ours"}, {"peer", false},        {"ms", 3.0},
                               {"ms_p95", 4.8},  {"ms_min", 1.0},        {"bad_pct", 2.0},
                               {"mae_mm", 40.0}, {"band_bad_pct", 12.5}, {"bytes", 3e6},
                               {"copy_ms", 2.0}, {"key_iou", 0.95}};
  ASSERT_EQ(rows[0].size(), ours.size()) << rows[0];
  for (const auto& [key, value] : ours.items()) {
    ASSERT_TRUE(rows[0].contains(key)) << key;
    if (value.is_number())
      EXPECT_NEAR(rows[0][key].get<double>(), value.get<double>(), 1e-6) << key;
    else
      EXPECT_EQ(rows[0][key], value) << key;
  }
  EXPECT_TRUE(rows[1]["peer"].get<bool>());
  for (const char* key : {"bad_pct", "mae_mm", "bytes", "copy_ms", "key_iou"})
    EXPECT_FALSE(rows[1].contains(key)) << key;
}

TEST(SuiteReport, ARowWithoutTimesHasNone) {
  Suite suite = suite_of_two();
  suite.rows[0].times_ms.clear();
  EXPECT_FALSE(to_json(suite, 1e9)[0].contains("ms"));
  EXPECT_TRUE(plot_of(suite).series.size() == 1 && plot_of(suite).series[0].name == "library");
}

TEST(SuiteReport, TableMarksOtherLibrariesAndMissingValues) {
  const std::string table = to_table(suite_of_two(), 1e9);
  EXPECT_NE(table.find("\n* library::function"), std::string::npos) << table;
  EXPECT_NE(table.find("  -"), std::string::npos);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
}

TEST(SuiteReport, PlotIsAFileOfSvg) {
  const report::Plot plot = plot_of(suite_of_two());
  ASSERT_EQ(plot.series.size(), 2U);
  EXPECT_DOUBLE_EQ(plot.series[0].points.at(0).x, 3);
  EXPECT_DOUBLE_EQ(plot.series[0].points.at(0).y, 12.5);
  const std::string svg = report::draw_svg(plot, {600, 400});
  EXPECT_NE(svg.find("<svg"), std::string::npos);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
}

// Expected values computed by hand for 1280x1024 and 512x424: 70 bytes per view pixel, 85 per ToF
// pixel.
TEST(MovedBytes, AreThoseOfTheStages) {
  const Size view{1280, 1024}, tof{512, 424};
  EXPECT_DOUBLE_EQ(moved_bytes(view, tof), 1280.0 * 1024 * 70 + 512.0 * 424 * 85);
  EXPECT_DOUBLE_EQ(moved_bytes(render::Stage::kKey, view, tof), 1280.0 * 1024 * 11);
  EXPECT_DOUBLE_EQ(moved_bytes(render::Stage::kFocus, view, tof), 0);
}

}  // namespace
}  // namespace mixrig::bench

// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/suites.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studio/io/studio_take.h"

namespace mixrig::bench {
namespace {

namespace fs = std::filesystem;

/// A small take of the studio, rendered once.
class Suites : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = (fs::temp_directory_path() / "mixrig-bench-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    studio::StudioOptions options;
    options.scenario = studio::Scenario::kWalk;
    options.rig = studio::RigPreset::kSr3000;
    options.seed = 7, options.frames = 16, options.size_px = {160, 128};
    const auto written = studio_io::write_studio_take(options, folder_ / "take",
                                                      take::StreamFormat::kPng, [](int) {});
    ASSERT_TRUE(written) << to_line(written.error());
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }
  static Result<Suite> run(const char* name) {
    return run_suite(name, {folder_ / "take", false, true}, {});
  }
  static fs::path folder_;
};
fs::path Suites::folder_;

double value(const Row& row, const std::string& key) {
  for (const auto& [name, number] : row.more)
    if (name == key) return number;
  ADD_FAILURE() << row.name << " has no " << key;
  return -1;
}

const Row& row_of(const Suite& suite, const std::string& name) {
  for (const Row& row : suite.rows)
    if (row.name == name) return row;
  ADD_FAILURE() << "no row " << name;
  return suite.rows.front();
}

TEST_F(Suites, KeyJudgesEachRung) {
  const auto suite = run("key");
  ASSERT_TRUE(suite) << to_line(suite.error());
  const Row& depth = row_of(*suite, "depth, 1 thread");
  const Row& refined = row_of(*suite, "refined, 1 thread");
  EXPECT_GT(value(refined, "key_iou"), value(depth, "key_iou"));
  EXPECT_LT(value(refined, "matte_mse"), value(depth, "matte_mse"));
  EXPECT_EQ(refined.times_ms.size(), 6U) << "a time for each of six frames";
  EXPECT_FALSE(refined.band_bad_pct) << "no depth is judged";
  EXPECT_DOUBLE_EQ(refined.bytes.value_or(0), 160 * 128 * 11);
  // Threads change no pixel.
  EXPECT_EQ(value(refined, "matte_mse"),
            value(row_of(*suite, "refined, all threads"), "matte_mse"));
}

TEST_F(Suites, RefineHoldsDepthOfTheKeyAgainstTheWarped) {
  const auto suite = run("refine");
  ASSERT_TRUE(suite) << to_line(suite.error());
  const Row& warped = row_of(*suite, "warped depth");
  EXPECT_TRUE(warped.times_ms.empty());
  ASSERT_TRUE(warped.band_bad_pct && row_of(*suite, "refined, 1 thread").band_bad_pct);
  EXPECT_LT(*row_of(*suite, "refined, 1 thread").band_bad_pct, *warped.band_bad_pct);
}

TEST_F(Suites, MemoryGrowsWithTheSize) {
  const auto suite = run("memory");
  ASSERT_TRUE(suite) << to_line(suite.error());
  EXPECT_GT(value(row_of(*suite, "cpu, 4/4 of the size"), "heap_mb"),
            value(row_of(*suite, "cpu, 2/4 of the size"), "heap_mb"));
}

TEST_F(Suites, OthersRun) {
  for (const char* name : {"warp", "mix", "shadow", "frame"}) {
    const auto suite = run(name);
    ASSERT_TRUE(suite) << name << ": " << to_line(suite.error());
    EXPECT_FALSE(to_json(*suite, 1e9).empty());
    EXPECT_FALSE(plot_of(*suite).series.empty()) << name;
  }
}

TEST_F(Suites, ATakeWithoutTruthIsRefused) {
  const fs::path bare = folder_ / "bare";
  fs::copy(folder_ / "take", bare, fs::copy_options::recursive);
  fs::remove_all(bare / "truth");
  const auto suite = run_suite("warp", {bare, false, true}, {});
  EXPECT_FALSE(suite);
}

}  // namespace
}  // namespace mixrig::bench

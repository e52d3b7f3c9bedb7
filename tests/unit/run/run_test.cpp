// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/run.h"

#include <cstdlib>
#include <tuple>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/support/box_source.h"
#include "tests/support/refusal.h"

namespace mixrig::session {
namespace {
namespace fs = std::filesystem;

/// Advances by three milliseconds at every reading.
class TickingClock final : public Clock {
 public:
  HostTime now() const override { return now_ += std::chrono::milliseconds(3); }
  void sleep_until(HostTime) override {}

 private:
  mutable HostTime now_{};
};

class RunTest : public ::testing::Test {
 protected:
  RunTest() {
    std::string pattern = (fs::temp_directory_path() / "mixrig-run-XXXXXX").string();
    root_ = mkdtemp(pattern.data());
    auto source = std::make_unique<test::BoxSource>(5, 8);
    source_ = source.get();
    session_.source = std::move(source);
    session_.scene.background.learn = {1, 5};
    session_.setup = *setup_of(source_->info(), std::nullopt);
    session_.backend = {render::Backend::kCpu, 1};
    options_.out = root_ / "out";
  }
  ~RunTest() override { fs::remove_all(root_); }
  RunParts parts() const { return {.stop = stop_}; }
  Result<RunReport> run_it() { return run(session_, options_, clock_, {}, parts()); }

  fs::path root_;
  Session session_;
  test::BoxSource* source_;
  RunOptions options_;
  const std::atomic<bool>* stop_ = nullptr;
  TickingClock clock_;
};

/// Fill over black and key: what a mixer takes.
TEST_F(RunTest, ALearnedRoomCanBeLeftOut) {
  session_.setup.backdrop.emplace();
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_FALSE(report->error->color_psnr_db);
  EXPECT_GT(*report->error->key_iou, 0.9);
  Image<std::uint8_t> alpha;
  ASSERT_TRUE(image_io::read_gray8(root_ / "out/alpha/000001.png", alpha));
  Image<Rgb8> color;
  ASSERT_TRUE(image_io::read_rgb8(root_ / "out/composite/color/000001.png", color));
  const int x = test::BoxSource::kLeft + 12, y = test::BoxSource::kTop + 12;
  EXPECT_EQ(alpha.at(x, y), 255);
  EXPECT_EQ(color.at(x, y), (Rgb8{200, 30, 30}));
  EXPECT_EQ(alpha.at(2, 2), 0);
  EXPECT_EQ(color.at(2, 2), (Rgb8{0, 0, 0}));
}

TEST_F(RunTest, KeysTheBoxAndJudgesIt) {
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->frames.frame_ms.count(), 3U);
  EXPECT_EQ(report->frames.frame_ms.min(), 3);
  EXPECT_EQ(report->frames.frame_ms.max(), 3);
  const double box_pct = 100.0 * test::BoxSource::kSide * test::BoxSource::kSide / (64 * 48);
  ASSERT_EQ(report->frames.foreground_pct.count(), 3U);
  EXPECT_NEAR(report->frames.foreground_pct.min(), box_pct, 1.0);
  ASSERT_TRUE(report->error);
  EXPECT_GT(*report->error->key_iou, 0.95);
  EXPECT_EQ(report->error->order_wrong_pct, std::nullopt) << "nothing virtual here";
}

TEST_F(RunTest, JudgesBaselinesBesideIt) {
  options_.baselines = true;
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->frames.frame_ms.max(), 3) << "outside the timed pass";
  ASSERT_EQ(report->baselines.size(), 4U);
  const auto& [plate, pasted, depth_key, ideal] = std::tie(
      report->baselines[0], report->baselines[1], report->baselines[2], report->baselines[3]);
  EXPECT_EQ(plate.baseline, measure::Baseline::kPlate);
  EXPECT_EQ(plate.errors.key_iou, 0.0);
  EXPECT_EQ(plate.errors.depth_bad_pct, std::nullopt) << "it has no depth";
  EXPECT_EQ(pasted.errors.color_psnr_db, plate.errors.color_psnr_db) << "nothing to paste";
  EXPECT_GT(*depth_key.errors.key_iou, 0.95) << "a box whose borders are those of ToF pixels";
  EXPECT_LT(*depth_key.errors.depth_bad_pct, 5.0);
  EXPECT_EQ(ideal.errors.color_psnr_db, plate.errors.color_psnr_db) << "no shadow, nothing virtual";
  EXPECT_EQ(ideal.errors.key_iou, std::nullopt) << "it would be the truth itself";
}

TEST_F(RunTest, RefusesBaselinesOfWhatHasNone) {
  options_.baselines = true;
  session_.setup.backdrop.emplace();
  EXPECT_TRUE(test::refused(run_it(), {"--baselines"}, ErrorCode::kUsage));
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(RunTest, WritesATakeASheetAndAReport) {
  options_.output.layers = options_.output.inspect = true;
  ASSERT_TRUE(run_it());
  auto reader = take::TakeReader::open(root_ / "out" / "composite");
  ASSERT_TRUE(reader) << reader.error().context;
  EXPECT_EQ(reader->info().frames, 3);
  capture::Capture frame;
  ASSERT_TRUE(reader->read(1, frame));
  EXPECT_EQ(frame.plate.at(32, 24), (Rgb8{200, 30, 30})) << "nothing virtual: the plate";
  EXPECT_NEAR(frame.depth_m.at(32, 24), 2.0F, 2e-3F);
  Image<std::uint8_t> matte;
  ASSERT_TRUE(image_io::read_gray8(root_ / "out" / "matte" / "000003.png", matte));
  EXPECT_EQ(matte.at(32, 24), 255);
  Image<std::uint16_t> depth_mm;
  ASSERT_TRUE(image_io::read_gray16(root_ / "out" / "segmented_depth" / "000003.png", depth_mm));
  EXPECT_NEAR(depth_mm.at(32, 24), 2000, 2);
  EXPECT_EQ(depth_mm.at(2, 2), 0);
  for (const char* name : {"contact_sheet.png", "report.json", "frames.csv", "key/000001.png",
                           "light/000001.png", "warped_depth/000001.png"})
    EXPECT_TRUE(fs::exists(root_ / "out" / name)) << name;
}

TEST_F(RunTest, JudgesASmallerViewAtTheTruthsSize) {
  session_.setup = *setup_of(source_->info(), Size{32, 24});
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->compositor.size, (Size{32, 24}));
  EXPECT_GT(*report->error->key_iou, 0.85);
}

TEST_F(RunTest, LeavesNothingWhereTheFirstFrameCannotBeRead) {
  source_->fails_at = 6;
  EXPECT_TRUE(test::refused(run_it(), {}, ErrorCode::kData));
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(RunTest, KeepsWhatWasWrittenBeforeAFault) {
  source_->fails_at = 7;
  EXPECT_TRUE(test::refused(run_it(), {"out.partial"}, ErrorCode::kData));
  EXPECT_EQ(take::TakeReader::open(root_ / "out.partial" / "composite")->info().frames, 1);
  EXPECT_FALSE(fs::exists(root_ / "out"));
  source_->fails_at = 0;
  ASSERT_TRUE(run_it());
  EXPECT_EQ(take::TakeReader::open(root_ / "out" / "composite")->info().frames, 3);
  EXPECT_EQ(take::TakeReader::open(root_ / "out.1.partial" / "composite")->info().frames, 1)
      << "the next run sets it aside";
}

TEST_F(RunTest, KeepsWhatWasWrittenBeforeMemoryEnds) {
  const auto no_memory = [](std::string_view what, int done, int) {
    if (what == "frames" && done == 2) throw std::bad_alloc();
  };
  EXPECT_TRUE(test::refused(run(session_, options_, clock_, no_memory, parts()),
                            {"no memory is left", "out.partial"}, ErrorCode::kIo));
  EXPECT_EQ(take::TakeReader::open(root_ / "out.partial" / "composite")->info().frames, 2);
}

TEST_F(RunTest, EndsWholeWhereTheSourceEnds) {
  source_->ends_at = 8;
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->ended, "end of the source");
  EXPECT_EQ(report->frames.frame_ms.count(), 2U);
  EXPECT_EQ(take::TakeReader::open(root_ / "out" / "composite")->info().frames, 2);
}

TEST_F(RunTest, AStopLeavesAWholeOutput) {
  std::atomic<bool> stop = false;
  stop_ = &stop;
  const auto report = run(
      session_, options_, clock_,
      [&](std::string_view what, int done, int) { stop = what == "frames" && done == 2; }, parts());
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->ended, "stopped");
  EXPECT_EQ(take::TakeReader::open(root_ / "out" / "composite")->info().frames, 2);
}

TEST_F(RunTest, AStopBeforeTheFirstFrameLeavesNothing) {
  std::atomic<bool> stop = true;
  stop_ = &stop;
  EXPECT_FALSE(run_it());
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(RunTest, RefusesFramesOutOfRange) {
  for (FrameRange range : {FrameRange{0, 2}, FrameRange{7, 9}, FrameRange{3, 2}}) {
    options_.frames = range;
    EXPECT_TRUE(test::refused(run_it(), {}, ErrorCode::kUsage));
  }
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(RunTest, NeedsAFrameThatIsNotLearned) {
  session_.scene.background.learn = {1, 8};
  EXPECT_TRUE(test::refused(run_it(), {}, ErrorCode::kUsage));
}

}  // namespace
}  // namespace mixrig::session

// SPDX-License-Identifier: Apache-2.0
// Sinks of a run: a slow one does not affect the others; images that none requires are not made.
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/run/loop/run.h"
#include "tests/support/progress.h"

namespace mixrig::session {
namespace {

/// Counts the frames; write() waits while the sink is held.
class CountingSink final : public output::CompositeSink {
 public:
  struct State {
    std::mutex mutex;
    std::condition_variable changed;
    bool held = false;
    int entered = 0, written = 0;
    void release() {
      const std::lock_guard lock(mutex);
      held = false;
      changed.notify_all();
    }
    bool has_entered() {
      const std::lock_guard lock(mutex);
      return entered > 0;
    }
    int count() {
      const std::lock_guard lock(mutex);
      return written;
    }
  };
  CountingSink(State& state, std::string_view name) : state_(state), name_(name) {}
  std::string_view name() const override { return name_; }
  render::OutputMask wanted(int) const override { return render::kColor; }
  Result<void> write(const output::CompositePtr& composite) override {
    EXPECT_EQ(composite->images.color.at(3, 3), (Rgb8{90, 90, 90}));
    EXPECT_TRUE(composite->images.mixed_depth_m.empty()) << "no sink of this live run requires it";
    std::unique_lock lock(state_.mutex);
    ++state_.entered;
    state_.changed.wait(lock, [this] { return !state_.held; });
    ++state_.written;
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  State& state_;
  std::string_view name_;
};

/// A live source: gives the next frame after the fast sink has written the one before.
class PacedSource final : public capture::CaptureSource {
 public:
  PacedSource(int frames, CountingSink::State& fast, CountingSink::State& slow)
      : frames_(frames), fast_(fast), slow_(slow) {
    info_.frames = capture::kEndless;
    info_.name = "paced";
    info_.target.pinhole = {{64, 48}, 60, 60, 31.5, 23.5};
    info_.tof = info_.target;
  }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, capture::Capture& capture) override {
    EXPECT_TRUE(test::comes_true([&] { return fast_.count() >= number - 1; }));
    if (number == 2) {
      EXPECT_TRUE(test::comes_true([&] { return slow_.has_entered(); }));
    }
    if (number > frames_) {
      slow_.release();
      return false;
    }
    capture.number = number;
    capture.plate.reset({64, 48}, {90, 90, 90});
    capture.depth_m.reset({64, 48}, 3.0F);
    return true;
  }
  Result<void> read_truth(int, capture::Truth&) override {
    return Error{ErrorCode::kData, "no truth"};
  }
  std::optional<capture::SourceReport> report() const override { return capture::SourceReport{}; }

 private:
  int frames_;
  CountingSink::State &fast_, &slow_;
  capture::SourceInfo info_;
};

TEST(SinkRun, ASinkThatIsStuckLosesItsOwnFramesOnly) {
  constexpr int kFrames = 60;
  CountingSink::State fast, slow;
  slow.held = true;
  Session session;
  session.source = std::make_unique<PacedSource>(kFrames, fast, slow);
  session.setup = *setup_of(session.source->info(), std::nullopt);
  session.backend = {render::Backend::kCpu, 1};
  RunParts parts;
  parts.sinks.push_back(std::make_unique<CountingSink>(slow, "slow"));
  parts.sinks.push_back(std::make_unique<CountingSink>(fast, "fast"));
  const ManualClock clock;  // at the exposure of every capture: none is late
  const auto report = run(session, {}, clock, {}, std::move(parts));
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->frames.frame_ms.count(), static_cast<std::uint64_t>(kFrames));
  EXPECT_EQ(report->ended, "end of the source");
  ASSERT_EQ(report->sinks.size(), 2U);
  EXPECT_EQ(report->sinks[1].written, static_cast<std::uint64_t>(kFrames));
  EXPECT_EQ(report->sinks[1].dropped, 0U);
  EXPECT_EQ(report->sinks[0].written, 3U) << "the one it held and the two that waited";
  EXPECT_EQ(report->sinks[0].dropped, static_cast<std::uint64_t>(kFrames) - 3U);
  EXPECT_EQ(to_json(*report)["sinks"][0]["dropped"], kFrames - 3);
  EXPECT_NE(to_table(*report).find("sink slow: 3 frames written"), std::string::npos);
}

/// A recording of a grey wall, 3 m away, with its truth.
class WallSource final : public capture::CaptureSource {
 public:
  WallSource() {
    info_.frames = 6;
    info_.has_truth = true;
    info_.name = "wall";
    info_.target.pinhole = {{64, 48}, 60, 60, 31.5, 23.5};
    info_.tof = info_.target;
  }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, capture::Capture& capture) override {
    capture.number = number;
    capture.plate.reset({64, 48}, {90, 90, 90});
    capture.depth_m.reset({64, 48}, 3.0F);
    return number <= info_.frames;
  }
  Result<void> read_truth(int, capture::Truth& truth) override {
    truth.depth_m.reset({64, 48}, 3.0F);
    truth.matte.reset({64, 48}, 0);
    truth.light.reset({64, 48}, 1.0F);
    truth.composite.reset({64, 48}, {90, 90, 90});
    truth.labels.reset({64, 48}, capture::Truth::kTofSees);
    return {};
  }

 private:
  capture::SourceInfo info_;
};

/// Requires the warped depth of even frames, or the colour of all. Records the warped depth in the
/// middle of each composite, 0 for a composite without it.
class DepthSink final : public output::CompositeSink {
 public:
  DepthSink(bool inspects, std::vector<long>& seen_mm) : inspects_(inspects), seen_mm_(seen_mm) {}
  std::string_view name() const override { return inspects_ ? "inspects" : "colour"; }
  render::OutputMask wanted(int number) const override {
    if (!inspects_) return render::kColor;
    return number % 2 == 0 ? render::kWarpedDepth : 0;
  }
  Result<void> write(const output::CompositePtr& composite) override {
    const Image<float>& depth_m = composite->images.warped_depth_m;
    seen_mm_.push_back(depth_m.empty() ? 0 : std::lround(1e3F * depth_m.at(32, 24)));
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  bool inspects_;
  std::vector<long>& seen_mm_;
};

TEST(SinkRun, ImagesThatOnlyJudgesNeedDoNotWaitForASink) {
  std::vector<long> inspected_mm, colored_mm;
  Session session;
  session.source = std::make_unique<WallSource>();
  session.setup = *setup_of(session.source->info(), std::nullopt);
  session.backend = {render::Backend::kCpu, 1};
  RunParts parts;
  parts.sinks.push_back(std::make_unique<DepthSink>(true, inspected_mm));
  parts.sinks.push_back(std::make_unique<DepthSink>(false, colored_mm));
  const auto report = run(session, {}, ManualClock(), {}, std::move(parts));
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(inspected_mm, std::vector<long>(3, 3000));
  EXPECT_EQ(colored_mm, (std::vector<long>{0, 3000, 0, 3000, 0, 3000}));
  ASSERT_TRUE(report->error);
  EXPECT_LT(report->error->depth_mae_mm.value_or(1), 0.01);
  EXPECT_EQ(report->error->color_psnr_db, 100);
  EXPECT_EQ(report->error->light_rmse, 0);
}

}  // namespace
}  // namespace mixrig::session

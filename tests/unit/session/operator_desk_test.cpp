// SPDX-License-Identifier: Apache-2.0
// A recording played as a live source, and composites recorded from it.
#include <gtest/gtest.h>

#include "host/session/composite_recorder.h"
#include "host/session/played_source.h"
#include "host/take/take_source.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

/// Three captures at 10 Hz whose number is their colour.
class ThreeFrames final : public capture::CaptureSource {
 public:
  ThreeFrames() {
    info_.name = "three", info_.frames = 3, info_.rate_hz = 10;
    info_.has_truth = true;
  }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, capture::Capture& capture) override {
    capture.plate.reset({4, 2}, Rgb8{static_cast<std::uint8_t>(number), 0, 0});
    capture.number = number;
    return true;
  }
  Result<void> read_truth(int, capture::Truth&) override { return {}; }

 private:
  capture::SourceInfo info_;
};

TEST(PlayedSource, ComesAtItsRateAgainAndAgain) {
  ManualClock clock;
  clock.advance(std::chrono::seconds(5));
  const auto source = played(std::make_unique<ThreeFrames>(), clock);
  EXPECT_EQ(source->info().frames, capture::kEndless);
  EXPECT_FALSE(source->info().has_truth);
  capture::Capture capture;
  std::vector<int> colors;
  std::vector<double> times_s;
  for (int number = 2; number <= 6; ++number) {
    ASSERT_TRUE(source->read(number, capture).value());
    EXPECT_EQ(capture.number, number);
    colors.push_back(capture.plate.at(0, 0).r);
    times_s.push_back(seconds(capture.mid_exposure.time_since_epoch()));
    EXPECT_GE(clock.now(), capture.mid_exposure);
  }
  EXPECT_EQ(colors, (std::vector<int>{2, 3, 1, 2, 3}));
  for (std::size_t i = 1; i < times_s.size(); ++i)
    EXPECT_NEAR(times_s[i] - times_s[i - 1], 0.1, 1e-9);
  clock.advance(std::chrono::seconds(1));  // a slow frame does not make the next ones hurry
  ASSERT_TRUE(source->read(7, capture).value());
  const HostTime late = capture.mid_exposure;
  ASSERT_TRUE(source->read(8, capture).value());
  EXPECT_NEAR(seconds(capture.mid_exposure - late), 0.1, 1e-9);
}

class Recorder : public ::testing::Test {
 protected:
  Recorder() : recorder_(session_, folder_.path() / "takes") {
    session_.source = std::make_unique<ThreeFrames>();
    session_.setup.view = {{16, 8}, 10, 10, 7.5, 3.5};
  }
  output::CompositePtr frame(int number, float depth_m = 2) {
    auto composite = std::make_shared<output::Composite>();
    auto capture = std::make_shared<capture::Capture>();
    capture->number = number;
    capture->time_s = 0.1 * number;
    capture->mid_exposure = HostTime(Duration(100'000'000LL * number));
    composite->capture = capture;
    composite->images.color.reset({16, 8}, Rgb8{10, 20, 30});
    composite->images.mixed_depth_m.reset({16, 8}, depth_m);
    composite->images.matte.reset({16, 8}, 0);
    composite->images.wanted = render::kComposite;
    return composite;
  }
  test::TemporaryFolder folder_;
  Session session_;
  CompositeRecorder recorder_;
};

TEST_F(Recorder, AStartAndAStopGiveATake) {
  recorder_.write(frame(1));  // nothing runs yet
  ASSERT_TRUE(recorder_.start("a b", "with \"notes\""));
  EXPECT_FALSE(recorder_.start("c", ""));
  for (const int number : {5, 6, 8}) recorder_.write(frame(number));
  EXPECT_TRUE(recorder_.state().on);
  EXPECT_EQ(recorder_.state().lost, 1U);
  EXPECT_NEAR(recorder_.state().seconds, 0.3, 1e-9);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "takes/a b"));
  ASSERT_TRUE(recorder_.stop());
  recorder_.write(frame(9));
  const auto state = recorder_.state();
  EXPECT_FALSE(state.on);
  EXPECT_EQ(state.frames, 3U);
  const auto source = take::TakeReader::open(folder_.path() / "takes/a b/composite");
  ASSERT_TRUE(source) << to_line(source.error());
  EXPECT_EQ(source->info().frames, 3);
  EXPECT_NE(test::read_bytes(folder_.path() / "takes/a b/recording.toml").find("\\\"notes\\\""),
            std::string::npos);
  EXPECT_EQ(recorder_.start("a b", "").error().code, ErrorCode::kUsage) << "the name is taken";
}

TEST_F(Recorder, WithoutANameTakesAreNumberedAndWithoutAFrameThereIsNone) {
  EXPECT_FALSE(recorder_.stop());
  ASSERT_TRUE(recorder_.start("", ""));
  EXPECT_EQ(recorder_.state().name, "take 1");
  EXPECT_EQ(recorder_.stop().error().code, ErrorCode::kData);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "takes/take 1"));
  ASSERT_TRUE(recorder_.start("", ""));
  recorder_.write(frame(1));
  ASSERT_TRUE(recorder_.stop());
  ASSERT_TRUE(recorder_.start("", ""));
  EXPECT_EQ(recorder_.state().name, "take 2");
}

TEST_F(Recorder, AFaultEndsTheRecordingAlone) {
  std::ofstream(folder_.path() / "takes") << "a file in the way";
  EXPECT_FALSE(recorder_.start("a", ""));
  EXPECT_FALSE(recorder_.is_on());
}

}  // namespace
}  // namespace mixrig::session

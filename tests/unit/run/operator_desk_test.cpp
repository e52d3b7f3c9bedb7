// SPDX-License-Identifier: Apache-2.0
// A recording played as a live source, composites recorded from it, and what keys and the page
// share.
#include "host/operator/desk/operator_desk.h"

#include <gtest/gtest.h>

#include "hal/fake/fake_camera.h"
#include "host/capture/open/played_source.h"
#include "host/capture/take/take_source.h"
#include "host/operator/desk/composite_recorder.h"
#include "tests/support/progress.h"
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

TEST_F(Recorder, ARecordingInSegmentsIsOneTake) {
  CompositeRecorder recorder(session_, folder_.path() / "takes", free_gb, 0.25);
  ASSERT_TRUE(recorder.start("day", ""));
  for (int number = 1; number <= 7; ++number) recorder.write(frame(number));
  ASSERT_TRUE(recorder.stop());
  const auto source = take::TakeReader::open(folder_.path() / "takes/day/composite");
  ASSERT_TRUE(source) << to_line(source.error());
  EXPECT_EQ(source->info().frames, 7);
  EXPECT_EQ(source->info().segments, 3);
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

TEST_F(Recorder, WhatARecordingThatWasCutOffHasLeftStays) {
  folder_.write("takes/take 1.partial/composite/color.mkv", "150 frames");
  folder_.write("takes/scene 1.partial/recording.toml", "name = \"scene 1.partial\"");
  ASSERT_TRUE(recorder_.start("", ""));
  EXPECT_EQ(recorder_.state().name, "take 2");
  recorder_.write(frame(1));
  ASSERT_TRUE(recorder_.stop());
  for (const char* name : {"take 1", "scene 1"}) {
    ASSERT_TRUE(recorder_.start(name, ""));
    recorder_.write(frame(1));
    ASSERT_TRUE(recorder_.stop());
  }
  EXPECT_EQ(test::read_bytes(folder_.path() / "takes/take 1.1.partial/composite/color.mkv"),
            "150 frames");
  EXPECT_FALSE(test::read_bytes(folder_.path() / "takes/scene 1.1.partial/recording.toml").empty());
}

TEST_F(Recorder, FramesThatComeFasterThanTheyAreWrittenAllAreInTheTake) {
  ASSERT_TRUE(recorder_.start("fast", ""));
  for (int number = 1; number <= 200; ++number) recorder_.write(frame(number));
  EXPECT_EQ(recorder_.state().frames, 200U);
  ASSERT_TRUE(recorder_.stop());
  EXPECT_EQ(recorder_.state().lost, 0U);
  const auto source = take::TakeReader::open(folder_.path() / "takes/fast/composite");
  ASSERT_TRUE(source) << to_line(source.error());
  EXPECT_EQ(source->info().frames, 200);
}

TEST_F(Recorder, AFaultWhileItIsWrittenEndsItAndIsTold) {
  ASSERT_TRUE(recorder_.start("a", ""));
  recorder_.write(frame(1));
  auto other = std::make_shared<output::Composite>(*frame(2));
  other->images.color.reset({8, 8});  // of another size: it cannot be encoded
  recorder_.write(other);
  EXPECT_TRUE(test::comes_true([&] { return !recorder_.is_on(); }));
  EXPECT_NE(recorder_.state().error, "");
  EXPECT_FALSE(recorder_.stop());
  EXPECT_EQ(recorder_.state().frames, 1U);
  EXPECT_EQ(recorder_.state().lost, 1U);
  const auto kept = take::TakeReader::open(folder_.path() / "takes/a/composite");
  ASSERT_TRUE(kept) << to_line(kept.error());
  EXPECT_EQ(kept->info().frames, 1) << "what was written before the fault stays";
  EXPECT_NE(test::read_bytes(folder_.path() / "takes/a/recording.toml").find("ended = "),
            std::string::npos);
  ASSERT_TRUE(recorder_.start("b", "")) << "the next one runs";
  recorder_.write(frame(3));
  EXPECT_TRUE(recorder_.stop());
}

TEST_F(Recorder, ADiskThatIsAlmostFullEndsItAndKeepsWhatIsThere) {
  std::atomic<int> looks = 0;  // at the start, and before each frame
  CompositeRecorder recorder(session_, folder_.path() / "takes",
                             [&](const std::filesystem::path&) { return looks++ < 3 ? 2 : 0.4; });
  ASSERT_TRUE(recorder.start("a", ""));
  for (int number = 1; number <= 3; ++number) recorder.write(frame(number));
  EXPECT_TRUE(test::comes_true([&] { return !recorder.is_on(); }));
  EXPECT_NE(recorder.state().error.find("disk almost full"), std::string::npos);
  EXPECT_EQ(recorder.state().frames, 2U);
  EXPECT_EQ(recorder.state().lost, 1U);
  const auto kept = take::TakeReader::open(folder_.path() / "takes/a/composite");
  ASSERT_TRUE(kept) << to_line(kept.error());
  EXPECT_EQ(kept->info().frames, 2);
  const auto refused = recorder.start("b", "");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().context.find("disk almost full"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "takes/b.partial"));
}

TEST_F(Recorder, WhatItsThreadThrowsEndsItAndKeepsWhatIsThere) {
  std::atomic<int> looks = 0;
  CompositeRecorder recorder(session_, folder_.path() / "takes",
                             [&](const std::filesystem::path&) -> std::optional<double> {
                               if (looks++ == 3) throw std::bad_alloc();
                               return 2;
                             });
  ASSERT_TRUE(recorder.start("a", ""));
  for (int number = 1; number <= 3; ++number) recorder.write(frame(number));
  EXPECT_TRUE(test::comes_true([&] { return !recorder.is_on(); }));
  EXPECT_NE(recorder.state().error.find("no memory is left"), std::string::npos);
  const auto kept = take::TakeReader::open(folder_.path() / "takes/a/composite");
  ASSERT_TRUE(kept) << to_line(kept.error());
  EXPECT_EQ(kept->info().frames, 2);
}

TEST_F(Recorder, AFaultEndsTheRecordingAlone) {
  std::ofstream(folder_.path() / "takes") << "a file in the way";
  EXPECT_FALSE(recorder_.start("a", ""));
  EXPECT_FALSE(recorder_.is_on());
}

class OperatorDeskTest : public Recorder {
 protected:
  OperatorDeskTest() {
    std::ofstream(folder_.path() / "scene.toml") << "[camera]\npose = \"take\"\n";
    session_.scene = scene::load_scene(folder_.path() / "scene.toml").value();
    desk_ = std::make_unique<OperatorDesk>(
        session_, std::make_shared<SceneFollower>(session_, false), orders_, clock_,
        DeskOptions{.takes = folder_.path() / "takes"});
  }
  ManualClock clock_;
  std::atomic<bool> stop_ = false;
  output::RunOrders orders_{stop_};
  std::unique_ptr<OperatorDesk> desk_;
};

TEST_F(OperatorDeskTest, AKeyAndThePageBeginAndEndTheSameRecording) {
  EXPECT_TRUE(orders_.state().records_takes);
  EXPECT_FALSE(orders_.state().recording);
  desk_->see(frame(1));
  ASSERT_TRUE(orders_.give(output::Record{true}));  // the key
  desk_->see(frame(2));
  EXPECT_TRUE(desk_->state().recording.on);
  EXPECT_EQ(desk_->apply(page::StartRecording{}).error().code, ErrorCode::kData);
  EXPECT_TRUE(orders_.state().recording);
  ASSERT_TRUE(desk_->apply(page::StopRecording{}));
  EXPECT_FALSE(orders_.state().recording) << "the key is told";
  ASSERT_TRUE(desk_->apply(page::StartRecording{"b", ""}));
  EXPECT_TRUE(orders_.state().recording);
  desk_->see(frame(3));
  ASSERT_TRUE(orders_.give(output::Record{false}));
  desk_->see(frame(4));
  EXPECT_FALSE(desk_->state().recording.on);
  EXPECT_EQ(desk_->state().recording.folder, (folder_.path() / "takes/b").string());
}

TEST_F(OperatorDeskTest, TheBackgroundIsLearnedWhereTheRunSaysThatItCan) {
  EXPECT_EQ(desk_->apply(page::LearnBackground{}).error().code, ErrorCode::kUnsupported);
  orders_.tell([](output::RunState& run) { run.can_learn = true; });
  EXPECT_TRUE(desk_->state().background_possible);
  EXPECT_TRUE(desk_->apply(page::LearnBackground{}));
  EXPECT_TRUE(orders_.take<output::LearnChanges>());
}

TEST_F(OperatorDeskTest, ARecordingHasNoCamerasToSet) {
  EXPECT_TRUE(desk_->state().cameras.empty());
  EXPECT_EQ(desk_->apply(page::SetCamera{"color", {{"gain", 2}}}).error().code,
            ErrorCode::kUnsupported);
}

TEST_F(OperatorDeskTest, ARecordingIsNotScannedByTheHead) {
  EXPECT_FALSE(desk_->state().sweep.possible);
  EXPECT_NE(desk_->state().sweep.why_not.find("a recording is played"), std::string::npos);
  EXPECT_EQ(desk_->apply(page::StartSweep{}).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(desk_->apply(page::CancelSweep{}).error().code, ErrorCode::kData);
  session_.rig = std::make_shared<live::RunningRig>();
  EXPECT_NE(desk_->state().sweep.why_not.find("[pan_tilt]"), std::string::npos) << "no head";
}

TEST_F(OperatorDeskTest, TheDepthOfFieldIsInTheScene) {
  const auto written = [&] { return test::read_bytes(folder_.path() / "scene.toml"); };
  EXPECT_FALSE(desk_->state().focus.on);
  ASSERT_TRUE(desk_->apply(page::SetFocus{.at = Eigen::Vector2d(0.5, 0.25)}));
  EXPECT_NE(written().find("[focus]\npixel = [8"), std::string::npos) << written();
  ASSERT_TRUE(desk_->apply(page::SetFocus{.distance_m = 2.5, .f_number = 1.4}));
  EXPECT_EQ(written().find("pixel"), std::string::npos);
  const auto scene = scene::load_scene(folder_.path() / "scene.toml").value();
  EXPECT_EQ(scene.focus->distance_m, 2.5);
  EXPECT_EQ(scene.focus->f_number, 1.4);
  ASSERT_TRUE(desk_->apply(page::SetFocus{.on = false}));
  EXPECT_EQ(written().find("focus"), std::string::npos);
  ASSERT_TRUE(desk_->apply(page::SetFocus{.on = true}));
  EXPECT_NE(written().find("pixel = [8"), std::string::npos) << "the middle";
}

TEST_F(OperatorDeskTest, WhatWasClickedInAWindowIsToldAndSaved) {
  session_.scene.focus.emplace().distance_m = 2;
  std::ofstream(folder_.path() / "scene.toml") << "[focus]\ndistance_m = 2.0\n";
  EXPECT_EQ(desk_->state().focus.distance_m, 2.0);
  ASSERT_TRUE(orders_.give(output::FocusAt{{4, 2}}));
  ASSERT_TRUE(desk_->state().focus.at);
  EXPECT_NEAR(desk_->state().focus.at->x(), 4.5 / 16, 1e-9);
  orders_.tell([](output::RunState& run) { run.can_focus = true; });
  ASSERT_TRUE(desk_->apply(page::SaveScene{}));
  const auto scene = scene::load_scene(folder_.path() / "scene.toml").value();
  EXPECT_EQ(scene.focus->pixel, std::pair(4, 2));
}

/// A source whose file is a rig.toml.
class OfARig final : public capture::CaptureSource {
 public:
  explicit OfARig(const std::filesystem::path& rig) { info_.name = "rig", info_.file = rig; }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int, capture::Capture&) override { return false; }
  Result<void> read_truth(int, capture::Truth&) override { return {}; }

 private:
  capture::SourceInfo info_;
};

TEST_F(OperatorDeskTest, ASettingOfACameraIsInForceAndInRigToml) {
  const auto rig = folder_.path() / "rig.toml";
  const std::string text = "format = 1\n# ours\n[[camera]]\nname = \"color\"\nuri = \"fake:\"\n";
  std::ofstream(rig) << text;
  session_.source = std::make_unique<OfARig>(rig);
  fake::FakeCamera camera(clock_,
                          {.uri = "fake:",
                           .size = {16, 12},
                           .format = device::PixelFormat::kRgb8,
                           .controls = {{device::CameraControl::kExposure, 1e-3, 0.04, 1e-3},
                                        {device::CameraControl::kZoom, 100, 400, 1}}});
  session_.calibration.origin = calibration_file::CalibrationOrigin::kFile;
  session_.cameras = std::make_shared<live::CameraSettings>();
  session_.cameras->follow({{"color", &camera}});
  ASSERT_TRUE(desk_->apply(page::SetCamera{"color", {{"exposure_ms", 8}}, true}));
  EXPECT_EQ(test::read_bytes(rig), text) << "a preview is not written";
  EXPECT_EQ(desk_->state().cameras.at(0).values.at(0).value, 8);
  EXPECT_EQ(desk_->state().cameras.at(0).values.at(0).maximum, 40);
  EXPECT_EQ(desk_->apply(page::SetCamera{"color", {{"exposure_ms", 80}}}).error().code,
            ErrorCode::kUsage);
  ASSERT_TRUE(desk_->apply(page::SetCamera{"color", {{"exposure_ms", 10}}}));
  EXPECT_NE(test::read_bytes(rig).find("exposure_ms = 10"), std::string::npos);
  EXPECT_NE(test::read_bytes(rig).find("# ours"), std::string::npos);
  EXPECT_NE(desk_->state().calibration.verdict, page::Verdict::kNoGo);
  ASSERT_TRUE(desk_->apply(page::SetCamera{"color", {{"zoom", 200}}}));
  EXPECT_NE(test::read_bytes(rig).find("zoom = 200"), std::string::npos);
  EXPECT_EQ(desk_->state().cameras.at(0).values.at(1).value, 200);
  EXPECT_EQ(desk_->state().calibration.verdict, page::Verdict::kNoGo) << "of another lens setting";
  session_.cameras->end();
  EXPECT_EQ(camera.get(device::CameraControl::kExposure).value(), 0.01);
  EXPECT_EQ(camera.get(device::CameraControl::kZoom).value(), 200);
}

}  // namespace
}  // namespace mixrig::session

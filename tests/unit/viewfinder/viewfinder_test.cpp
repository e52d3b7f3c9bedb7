// SPDX-License-Identifier: Apache-2.0
// The sink with SDL's dummy driver: keys, the end of a run, frames that come or not.
#include "host/output/viewfinder/viewfinder.h"

#include <atomic>
#include <cstdlib>

#include <SDL.h>
#include <gtest/gtest.h>

#include "tests/support/progress.h"
#include "tests/support/refusal.h"
#include "tests/support/threaded_clock.h"
#include "tests/support/throw_in.h"
#include "tests/unit/viewfinder/made_composite.h"

namespace mixrig::viewfinder {
namespace {

/// Devices that are there, and give nothing: composites come from the test.
class FakeSource final : public capture::CaptureSource {
 public:
  explicit FakeSource(bool live) { info_.frames = live ? capture::kEndless : 10; }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int, capture::Capture&) override { return false; }
  Result<void> read_truth(int, capture::Truth&) override { return {}; }
  std::optional<capture::SourceReport> report() const override {
    ++asked;
    return capture::SourceReport();
  }
  mutable std::atomic<int> asked = 0;

 private:
  capture::SourceInfo info_;
};

class ViewfinderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(setenv("SDL_VIDEODRIVER", "dummy", 1), 0);
    ASSERT_EQ(setenv("SDL_RENDER_DRIVER", "software", 1), 0);
  }
  std::unique_ptr<Viewfinder> open(View view = View::kComposite, bool live = true) {
    source_ = std::make_unique<FakeSource>(live);
    auto made = Viewfinder::create({.title = "test", .view = view, .picture_px = kMadeSize},
                                   *source_, orders_, clock_, report_);
    EXPECT_TRUE(made) << (made ? "" : to_line(made.error()));
    return made ? *std::move(made) : nullptr;
  }
  static void press(SDL_Keycode code) {
    SDL_Event event{};
    event.type = SDL_KEYDOWN;
    event.key.keysym.sym = code;
    ASSERT_EQ(SDL_PushEvent(&event), 1) << SDL_GetError();
  }
  SystemClock clock_;
  std::atomic<bool> stop_ = false;
  output::RunOrders orders_{stop_};
  ViewfinderReport report_;
  std::unique_ptr<FakeSource> source_;
};

TEST_F(ViewfinderTest, WhatItsThreadThrowsIsItsError) {
  FakeSource source(true);
  const test::ThrowIn thrown("window");
  EXPECT_TRUE(test::refused(Viewfinder::create({.title = "test", .picture_px = kMadeSize}, source,
                                               orders_, clock_, report_),
                            {"window: no memory is left"}));
}

/// Sends a click at pixel (12, 34) of the picture.
bool click() {
  SDL_Event event{};
  event.type = SDL_MOUSEBUTTONDOWN;
  event.button.button = SDL_BUTTON_LEFT;
  event.button.x = 12, event.button.y = 34;
  return SDL_PushEvent(&event) == 1;
}

TEST_F(ViewfinderTest, ShowsOrReplacesEveryCompositeAndTheLastOneIsShown) {
  auto sink = open();
  ASSERT_TRUE(sink);
  for (int i = 1; i <= 20; ++i) ASSERT_TRUE(sink->write(made_composite(i, clock_.now())));
  ASSERT_TRUE(sink->finish());
  EXPECT_EQ(report_.shown + report_.replaced, 20U);
  EXPECT_GE(report_.shown, 1U);
  EXPECT_EQ(report_.delay_ms.count(), report_.shown);
  EXPECT_EQ(report_.driver, "dummy, software");
}

TEST_F(ViewfinderTest, TheLogOfAMeasurementHoldsWhatWasShownWhen) {
  source_ = std::make_unique<FakeSource>(true);
  output::ShownLog log;
  log.empty.reset(kMadeSize, {0, 0, 0});
  log.reserve(4);
  auto sink = Viewfinder::create({.title = "test", .picture_px = kMadeSize, .log = &log}, *source_,
                                 orders_, clock_, report_);
  ASSERT_TRUE(sink) << to_line(sink.error());
  auto made = made_composite(7, clock_.now());
  made->images.color.reset(kMadeSize, {0, 0, 0});
  for (int y = 0; y < kMadeSize.height; ++y)
    for (int x = 100; x < 110; ++x) made->images.color.at(x, y) = {200, 200, 200};
  made->frame_ms = 12;
  ASSERT_TRUE((*sink)->write(made));
  ASSERT_TRUE((*sink)->finish());
  ASSERT_EQ(log.frames.size(), 1U);
  const output::ShownFrame& frame = log.frames[0];
  EXPECT_EQ(frame.number, 7);
  EXPECT_EQ(frame.frame_ms, 12);
  EXPECT_LE(frame.exposed, frame.handed);
  EXPECT_LE(frame.handed, frame.shown);
  EXPECT_NEAR(frame.column.value_or(0), 104, 1e-9) << "every second column";
}

TEST_F(ViewfinderTest, ItsViewDecidesWhichImagesARunMakes) {
  auto sink = open(View::kMatte);
  ASSERT_TRUE(sink);
  EXPECT_EQ(sink->wanted(1), render::kMatte);
  press(SDLK_3);
  EXPECT_TRUE(test::comes_true([&] { return sink->wanted(1) == render::kState; }));
  press(SDLK_KP_4);
  EXPECT_TRUE(test::comes_true([&] { return sink->wanted(1) == render::kMixedDepth; }));
  ASSERT_TRUE(sink->write(made_composite()));  // in a view whose depth has a range of its own
  ASSERT_TRUE(sink->finish());
}

TEST_F(ViewfinderTest, ClosingTheWindowEndsTheRunAndSoDoesQ) {
  auto sink = open();
  ASSERT_TRUE(sink);
  SDL_Event event{};
  event.type = SDL_WINDOWEVENT;
  event.window.event = SDL_WINDOWEVENT_CLOSE;
  ASSERT_EQ(SDL_PushEvent(&event), 1);
  EXPECT_TRUE(test::comes_true([&] { return stop_.load(); }));
  stop_ = false;
  press(SDLK_q);
  EXPECT_TRUE(test::comes_true([&] { return stop_.load(); }));
  ASSERT_TRUE(sink->write(made_composite())) << "a frame that was in work is still taken";
  ASSERT_TRUE(sink->finish());
}

TEST_F(ViewfinderTest, EscapeEndsTheRunOnlyWhenItIsPressedTwice) {
  const FakeSource source(true);
  test::SteppedClock clock;
  auto made = Viewfinder::create({.title = "test", .picture_px = kMadeSize}, source, orders_, clock,
                                 report_);
  ASSERT_TRUE(made);
  // A view that is shown tells that the Escape before was handled.
  for (const View view : {View::kPlate, View::kMatte}) {
    press(SDLK_ESCAPE), press(view == View::kPlate ? SDLK_2 : SDLK_6);
    ASSERT_TRUE(test::comes_true([&] { return orders_.state().view == view; }));
    EXPECT_FALSE(stop_);
    clock.advance(std::chrono::seconds(3));
  }
  press(SDLK_ESCAPE), press(SDLK_ESCAPE);
  EXPECT_TRUE(test::comes_true([&] { return stop_.load(); }));
  ASSERT_TRUE((*made)->finish());
}

TEST_F(ViewfinderTest, LearnAndRecordOnlyWhereTheRunCan) {
  auto sink = open();
  ASSERT_TRUE(sink);
  press(SDLK_b), press(SDLK_r), press(SDLK_2);
  ASSERT_TRUE(test::comes_true([&] { return sink->wanted(1) == render::kMatte; }));
  EXPECT_FALSE(orders_.waits<output::LearnChanges>() || orders_.waits<output::Record>());
  orders_.tell([](output::RunState& run) { run.can_learn = run.can_record = true; });
  press(SDLK_b), press(SDLK_r);
  EXPECT_TRUE(test::comes_true([&] { return orders_.waits<output::Record>(); }));
  EXPECT_TRUE(orders_.take<output::LearnChanges>());
  EXPECT_FALSE(orders_.state().recording) << "as it was asked for";
  press(SDLK_r);
  EXPECT_TRUE(test::comes_true([&] { return orders_.state().recording; }));
  EXPECT_FALSE(orders_.take<output::Record>()->on);
  EXPECT_TRUE(orders_.take<output::Record>()->on);
}

TEST_F(ViewfinderTest, OAndAClickAskForAnObjectToBePlaced) {
  auto sink = open();
  ASSERT_TRUE(sink);
  ASSERT_TRUE(sink->write(made_composite(1, clock_.now())));
  press(SDLK_o), press(SDLK_2);  // the run has told of no object
  ASSERT_TRUE(test::comes_true([&] { return orders_.state().view == View::kPlate; }));
  EXPECT_TRUE(click());
  orders_.tell([](output::RunState& run) { run.objects = 2; });
  press(SDLK_o), press(SDLK_o);
  EXPECT_TRUE(test::comes_true([&] { return click() && orders_.waits<output::PlaceObject>(); }));
  const auto order = orders_.take<output::PlaceObject>();
  EXPECT_EQ(order->pixel, glm::ivec2(12, 34));
  EXPECT_EQ(order->object, 1);
  EXPECT_FALSE(orders_.state().focus_px);
  EXPECT_TRUE(sink->finish());
}

TEST_F(ViewfinderTest, AClickChoosesWhatIsSharpWhereTheSceneHasAFocus) {
  auto sink = open();
  ASSERT_TRUE(sink);
  ASSERT_TRUE(sink->write(made_composite(1, clock_.now())));
  EXPECT_TRUE(click());
  orders_.tell([](output::RunState& run) { run.can_focus = true; });
  EXPECT_TRUE(test::comes_true([&] { return click() && orders_.state().focus_px; }));
  EXPECT_EQ(orders_.state().focus_px, glm::ivec2(12, 34));
  EXPECT_TRUE(sink->finish());
}

TEST_F(ViewfinderTest, AsksTheDevicesWhileNothingComesAndARecordingNever) {
  auto sink = open();
  ASSERT_TRUE(sink);
  EXPECT_TRUE(test::comes_true([&] { return source_->asked > 1; }));
  sink.reset();  // one window at a time
  sink = open(View::kComposite, false);
  ASSERT_TRUE(sink);
  ASSERT_TRUE(sink->write(made_composite()));
  ASSERT_TRUE(sink->finish());
  EXPECT_EQ(report_.shown, 1U);
  EXPECT_EQ(report_.delay_ms.count(), 0U) << "the times of a recording are of another clock";
}

TEST_F(ViewfinderTest, WithoutAScreenItIsAnErrorThatSaysWhatToDo) {
  ASSERT_EQ(setenv("SDL_VIDEODRIVER", "no_such_driver", 1), 0);
  source_ = std::make_unique<FakeSource>(true);
  const auto made = Viewfinder::create({.title = "test", .picture_px = kMadeSize}, *source_,
                                       orders_, clock_, report_);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kDevice);
  EXPECT_NE(made.error().context.find("set DISPLAY"), std::string::npos) << made.error().context;
}

}  // namespace
}  // namespace mixrig::viewfinder

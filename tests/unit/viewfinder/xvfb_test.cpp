// SPDX-License-Identifier: Apache-2.0
// The viewfinder in a window of an X server without a screen (Xvfb), whose picture the server
// itself writes into a file.
#include <array>
#include <cstdlib>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "host/render/gles/compositor_gles.h"
#include "host/viewfinder/viewfinder.h"
#include "tests/support/child_process.h"
#include "tests/support/progress.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/threaded_clock.h"
#include "tests/unit/render/helpers.h"
#include "tests/unit/viewfinder/made_composite.h"

namespace mixrig::viewfinder {
namespace {

using namespace std::chrono_literals;

constexpr Size kScreen{640, 480};

bool has_xvfb() { return std::system("command -v Xvfb >/dev/null 2>&1") == 0; }

/// A server on a display that it finds free.
class Xvfb {
 public:
  Xvfb()
      : server_({"Xvfb", "-displayfd", "1", "-screen", "0", "640x480x24", "-fbdir",
                 folder_.path().string(), "-nolisten", "tcp", "-nocursor"},
                120, (folder_ / "display").string(), (folder_ / "errors").string()) {}
  /// ":7"; empty where it does not start.
  std::string display() const {
    std::string number;
    test::comes_true([&] {
      number = test::read_bytes(folder_ / "display");
      return number.ends_with('\n');
    });
    return number.empty() ? number : ":" + number.substr(0, number.size() - 1);
  }
  /// The screen, from the server's file in the format of xwd(1): a header of big-endian words,
  /// colours of twelve bytes each, and pixels of four.
  Image<Rgb8> screen() const {
    const std::string bytes = test::read_bytes(folder_ / "Xvfb_screen0");
    const auto word = [&](std::size_t index) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < 4; ++i)
        value = value << 8 | static_cast<std::uint8_t>(bytes.at(4 * index + i));
      return value;
    };
    Image<Rgb8> out({static_cast<int>(word(4)), static_cast<int>(word(5))});
    const std::size_t first = word(0) + 12 * word(19), line = word(12);
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x) {
        const std::size_t at =
            first + static_cast<std::size_t>(y) * line + 4 * static_cast<std::size_t>(x);
        const auto byte = [&](std::size_t i) {
          return static_cast<std::uint8_t>(bytes.at(at + i));
        };
        out.at(x, y) = {byte(2), byte(1), byte(0)};
      }
    return out;
  }

 private:
  test::TemporaryFolder folder_;
  test::ChildProcess server_;
};

class XvfbTest : public ::testing::Test {
 protected:
  void SetUp() override { open("software", false); }
  void open(const char* renderer, bool shares) {
    if (!has_xvfb()) GTEST_SKIP() << "Xvfb is not installed: scripts/setup peers";
    server_.emplace();
    const std::string display = server_->display();
    ASSERT_FALSE(display.empty()) << "Xvfb does not start";
    setenv("DISPLAY", display.c_str(), 1);
    setenv("SDL_VIDEODRIVER", "x11", 1);
    setenv("SDL_RENDER_DRIVER", renderer, 1);
    auto made = Viewfinder::create({.title = "test", .picture_px = kMadeSize, .shares = shares},
                                   source_, controls_, clock_, report_);
    ASSERT_TRUE(made) << to_line(made.error());
    sink_ = *std::move(made);
  }
  /// Where the window has the composite, pixel by pixel; the middle of the screen.
  bool shows_the_composite() const {
    const Image<Rgb8> screen = server_->screen();
    if (screen.size() != kScreen) return false;
    const int left = (kScreen.width - kMadeSize.width) / 2;
    const int top = (kScreen.height - kMadeSize.height) / 2;
    for (int y = 0; y < kMadeSize.height; ++y)
      for (int x = 0; x < kMadeSize.width; ++x)
        if (screen.at(left + x, top + y) != made_color(x, y)) return false;
    return true;
  }
  /// Colour of the window's top left pixel.
  Rgb8 corner() const {
    return server_->screen().at((kScreen.width - kMadeSize.width) / 2,
                                (kScreen.height - kMadeSize.height) / 2);
  }

  class Devices final : public capture::CaptureSource {
   public:
    Devices() { info_.frames = capture::kEndless, info_.rate_hz = 25; }
    const capture::SourceInfo& info() const override { return info_; }
    Result<bool> read(int, capture::Capture&) override { return false; }
    Result<void> read_truth(int, capture::Truth&) override { return {}; }

   private:
    capture::SourceInfo info_;
  };
  Devices source_;
  std::atomic<bool> stop_ = false;
  std::atomic<int> learn_ = 0;
  output::RunControls controls_{.stop = stop_, .learn = learn_};
  test::SteppedClock clock_;
  ViewfinderReport report_;
  std::optional<Xvfb> server_;
  std::unique_ptr<Viewfinder> sink_;
};

TEST_F(XvfbTest, TheWindowShowsTheCompositePixelByPixel) {
  ASSERT_TRUE(sink_->write(made_composite(1, clock_.now())));
  EXPECT_TRUE(test::comes_true([&] { return shows_the_composite(); }));
  ASSERT_TRUE(sink_->finish());
  EXPECT_EQ(report_.driver, "x11, software");
  EXPECT_EQ(report_.shown, 1U);
}

TEST_F(XvfbTest, APictureThatNoOtherFollowsIsMarkedThenTakenAwayAndTheNextOneIsLive) {
  constexpr Rgb8 kAlarm{255, 90, 70};
  ASSERT_TRUE(sink_->write(made_composite(1, clock_.now())));
  ASSERT_TRUE(test::comes_true([&] { return shows_the_composite(); }));
  clock_.advance(1s);
  EXPECT_TRUE(test::comes_true([&] { return corner() == kAlarm; }));
  clock_.advance(10s);
  const auto middle_is_empty = [&] {
    return server_->screen().at(kScreen.width / 2 + 40, kScreen.height / 2 + 40) ==
           (Rgb8{36, 36, 40});
  };
  EXPECT_TRUE(test::comes_true(middle_is_empty));
  ASSERT_TRUE(sink_->write(made_composite(2, clock_.now())));
  EXPECT_TRUE(test::comes_true([&] { return shows_the_composite(); }));
}

/// The gles back end's composites, by SDL's OpenGL ES.
class SharedXvfbTest : public XvfbTest {
 protected:
  void SetUp() override {
    open("opengles2", true);
    if (IsSkipped() || HasFatalFailure()) return;
    ASSERT_EQ(report_.driver, "x11, opengles2");
    ASSERT_NE(sink_->share().display, nullptr) << "SDL's OpenGL ES is of version 3";
    const render::CompositorSetup setup = test::plain_setup(kMadeSize, 150, {40, 30}, 37);
    auto made = render::make_gles_compositor(setup, sink_->share());
    ASSERT_TRUE(made) << to_line(made.error());
    compositor_ = *std::move(made);
  }
  void TearDown() override {
    compositor_.reset();  // before the window
    if (sink_) {
      ASSERT_TRUE(sink_->finish());
    }
  }
  /// A picture of the compositor, which is the plate: no object, no background.
  output::CompositePtr composited(int shift) {
    auto made = made_composite(1, clock_.now());
    Image<Rgb8> plate(kMadeSize);
    for (int y = 0; y < kMadeSize.height; ++y)
      for (int x = 0; x < kMadeSize.width; ++x) plate.at(x, y) = made_color(x + shift, y);
    const Image<float> depth({40, 30}, 2.0F);
    made->images = {};
    made->images.wanted = sink_->wanted(1);
    EXPECT_EQ(made->images.wanted, render::kGpuColor);
    EXPECT_TRUE(compositor_->compose({plate, depth, {}}, made->images));
    EXPECT_NE(made->images.gpu_color, nullptr);
    EXPECT_TRUE(made->images.color.empty()) << "it is not read back";
    return made;
  }
  std::unique_ptr<render::Compositor> compositor_;
};

TEST_F(SharedXvfbTest, ACompositeThatStaysInTheGpuIsShownPixelByPixel) {
  ASSERT_TRUE(sink_->write(composited(40)));
  EXPECT_FALSE(shows_the_composite());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(sink_->write(composited(7 * i)));
  ASSERT_TRUE(sink_->write(composited(0)));
  EXPECT_TRUE(test::comes_true([&] { return shows_the_composite(); }));
}

TEST_F(SharedXvfbTest, WhatIsOldIsMarkedOverIt) {
  constexpr Rgb8 kAlarm{255, 90, 70};
  ASSERT_TRUE(sink_->write(composited(0)));
  ASSERT_TRUE(test::comes_true([&] { return shows_the_composite(); }));
  clock_.advance(1s);
  EXPECT_TRUE(test::comes_true([&] { return corner() == kAlarm; }));
  const int x = kScreen.width / 2 - 40, y = (kScreen.height - kMadeSize.height) / 2 + 20;
  EXPECT_EQ(server_->screen().at(x, y), made_color(40, 20)) << "the picture is still below";
  clock_.advance(10s);
  const auto is_taken_away = [&] { return server_->screen().at(x, y) == (Rgb8{36, 36, 40}); };
  EXPECT_TRUE(test::comes_true(is_taken_away));
}

}  // namespace
}  // namespace mixrig::viewfinder

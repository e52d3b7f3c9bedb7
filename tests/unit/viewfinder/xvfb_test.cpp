// SPDX-License-Identifier: Apache-2.0
// The viewfinder in a window of an X server.
#include "tests/unit/viewfinder/xvfb.h"

#include <optional>
#include <string>

#include "tests/unit/viewfinder/window_test.h"

namespace mixrig::viewfinder {
namespace {

using namespace std::chrono_literals;

class XvfbTest : public WindowTest {
 protected:
  void SetUp() override { open("software", false); }
  void open(const char* renderer, bool shares) {
    if (!has_xvfb()) GTEST_SKIP() << "Xvfb is not installed: scripts/setup peers";
    server_.emplace();
    const std::string display = server_->display();
    ASSERT_FALSE(display.empty()) << "Xvfb does not start";
    setenv("DISPLAY", display.c_str(), 1);
    open_window("x11", renderer, shares);
  }
  /// Whether the window shows the composite, pixel by pixel, in the middle of the screen.
  bool shows_the_composite() const {
    const Image<Rgb8> screen = server_->screen();
    if (screen.size() != kScreen) return false;
    return has_made_picture(screen, (kScreen.width - kMadeSize.width) / 2,
                            (kScreen.height - kMadeSize.height) / 2);
  }
  /// Colour of the window's top left pixel.
  Rgb8 corner() const {
    return server_->screen().at((kScreen.width - kMadeSize.width) / 2,
                                (kScreen.height - kMadeSize.height) / 2);
  }

  std::optional<Xvfb> server_;
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
    make_compositor();
  }
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

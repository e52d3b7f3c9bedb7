// SPDX-License-Identifier: Apache-2.0
// The viewfinder in a window of a Wayland compositor (Weston), whose own window is all of the
// screen of an X server: SDL does not open a window on a compositor that has no seat.
#include <filesystem>
#include <optional>
#include <string>

#include "tests/unit/viewfinder/window_test.h"
#include "tests/unit/viewfinder/xvfb.h"

namespace mixrig::viewfinder {
namespace {

namespace fs = std::filesystem;

bool has_weston() { return std::system("command -v weston >/dev/null 2>&1") == 0; }

/// A Weston server whose socket is in its own folder, which becomes XDG_RUNTIME_DIR.
class Weston {
 public:
  explicit Weston(const std::string& display) {
    fs::permissions(folder_.path(), fs::perms::owner_all);
    setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1);
    setenv("DISPLAY", display.c_str(), 1);
    server_.emplace(std::vector<std::string>{"weston", "--backend=x11-backend.so", "--use-pixman",
                                             "--width=640", "--height=480", "--socket=mixrig-test",
                                             "--no-config"},
                    120, (folder_ / "weston.log").string());
    setenv("WAYLAND_DISPLAY", "mixrig-test", 1);
  }
  bool ready() const {
    return test::comes_true([&] { return fs::exists(folder_ / "mixrig-test"); });
  }

 private:
  test::TemporaryFolder folder_;
  std::optional<test::ChildProcess> server_;
};

class WaylandTest : public WindowTest {
 protected:
  void open(const char* renderer, bool shares) {
    if (!has_xvfb() || !has_weston())
      GTEST_SKIP() << "Xvfb or Weston is not installed: scripts/setup peers";
    screen_.emplace();
    const std::string display = screen_->display();
    ASSERT_FALSE(display.empty()) << "Xvfb does not start";
    weston_.emplace(display);
    ASSERT_TRUE(weston_->ready()) << "Weston does not start";
    open_window("wayland", renderer, shares);
  }
  /// Wherever Weston has put the window.
  bool shows_the_composite() const {
    const Image<Rgb8> screen = screen_->screen();
    for (int y = 0; y + kMadeSize.height <= screen.height(); ++y)
      for (int x = 0; x + kMadeSize.width <= screen.width(); ++x)
        if (has_made_picture(screen, x, y)) return true;
    return false;
  }

  std::optional<Xvfb> screen_;
  std::optional<Weston> weston_;
};

TEST_F(WaylandTest, TheWindowShowsTheCompositePixelByPixel) {
  open("software", false);
  if (IsSkipped() || HasFatalFailure()) return;
  EXPECT_EQ(report_.driver, "wayland, software");
  ASSERT_TRUE(sink_->write(made_composite(1, clock_.now())));
  EXPECT_TRUE(test::comes_true([&] { return shows_the_composite(); }));
  ASSERT_TRUE(sink_->finish());
}

TEST_F(WaylandTest, ACompositeThatStaysInTheGpuIsShownPixelByPixel) {
  open("opengles2", true);
  if (IsSkipped() || HasFatalFailure()) return;
  EXPECT_EQ(report_.driver, "wayland, opengles2");
  make_compositor();
  if (HasFatalFailure()) return;
  for (int i = 5; i > 0; --i) ASSERT_TRUE(sink_->write(composited(7 * i)));
  EXPECT_FALSE(shows_the_composite());
  ASSERT_TRUE(sink_->write(composited(0)));
  EXPECT_TRUE(test::comes_true([&] { return shows_the_composite(); }));
}

}  // namespace
}  // namespace mixrig::viewfinder

// SPDX-License-Identifier: Apache-2.0
// The viewfinder in a window of a display server that a test starts.
#pragma once

#include <atomic>
#include <cstdlib>
#include <memory>

#include <gtest/gtest.h>

#include "host/output/viewfinder/viewfinder.h"
#include "host/render/gles/compositor_gles.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"
#include "tests/unit/render/helpers.h"
#include "tests/unit/viewfinder/made_composite.h"

namespace mixrig::viewfinder {

/// Whether a screen has the made composite, pixel by pixel, with its corner at (left, top).
inline bool has_made_picture(const Image<Rgb8>& screen, int left, int top) {
  for (int y = 0; y < kMadeSize.height; ++y)
    for (int x = 0; x < kMadeSize.width; ++x)
      if (screen.at(left + x, top + y) != made_color(x, y)) return false;
  return true;
}

class WindowTest : public ::testing::Test {
 protected:
  /// Opens the viewfinder; `driver` and `renderer` are SDL's names.
  void open_window(const char* driver, const char* renderer, bool shares) {
    setenv("SDL_VIDEODRIVER", driver, 1);
    setenv("SDL_RENDER_DRIVER", renderer, 1);
    auto made = Viewfinder::create({.title = "test", .picture_px = kMadeSize, .shares = shares},
                                   source_, orders_, clock_, report_);
    ASSERT_TRUE(made) << to_line(made.error());
    sink_ = *std::move(made);
  }
  /// Makes a gles compositor in the window's context.
  void make_compositor() {
    ASSERT_NE(sink_->share().display, nullptr) << "SDL's OpenGL ES is of version 3";
    const render::CompositorSetup setup = test::plain_setup(kMadeSize, 150, {40, 30}, 37);
    auto made = render::make_gles_compositor(setup, sink_->share());
    ASSERT_TRUE(made) << to_line(made.error());
    compositor_ = *std::move(made);
  }
  /// A composite by the compositor above: the plate moved by `shift` columns, since there is
  /// neither object nor background.
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
  /// Runs before the derived class ends the display server.
  void TearDown() override {
    if (compositor_ && sink_) {
      compositor_.reset();  // before the window
      EXPECT_TRUE(sink_->finish());
    }
    sink_.reset();
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
  output::RunOrders orders_{stop_};
  test::SteppedClock clock_;
  ViewfinderReport report_;
  std::unique_ptr<Viewfinder> sink_;
  std::unique_ptr<render::Compositor> compositor_;
};

}  // namespace mixrig::viewfinder

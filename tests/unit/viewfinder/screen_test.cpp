// SPDX-License-Identifier: Apache-2.0
// The viewfinder's drawing for a state of the run, read back from its pixels.
#include "host/output/viewfinder/screen.h"

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "host/output/viewfinder/font.h"
#include "tests/support/count_allocations.h"
#include "tests/unit/viewfinder/made_composite.h"

namespace mixrig::viewfinder {
namespace {

using namespace std::chrono_literals;

bool is_text_at(ImageView<const Rgbx8> picture, int x0, int y0, const std::string& text,
                int scale) {
  const Rgbx8 ink = [&] {
    for (int y = 0; y < kGlyphHeight_px; ++y)
      for (int x = 0; x < kGlyphWidth_px; ++x)
        if (glyph_pixel(text[0], x, y)) return picture.at(x0 + x * scale, y0 + y * scale);
    return Rgbx8{};
  }();
  if (ink.r + ink.g + ink.b < 200) return false;
  for (std::size_t i = 0; i < text.size(); ++i)
    for (int y = 0; y < kGlyphHeight_px; ++y)
      for (int x = 0; x < kGlyphWidth_px; ++x) {
        const int left = x0 + (static_cast<int>(i) * kAdvance_px + x) * scale;
        const Rgbx8 p = picture.at(left, y0 + y * scale);
        const bool inked = p.r == ink.r && p.g == ink.g && p.b == ink.b;
        if (inked != glyph_pixel(text[i], x, y)) return false;
      }
  return true;
}

/// Whether the text appears anywhere in the picture, in any size.
bool reads(ImageView<const Rgbx8> picture, const std::string& text) {
  for (int scale = 1; scale <= 6; ++scale) {
    const Size size = text_size(text, scale);
    for (int y = 0; y + size.height <= picture.size.height; ++y)
      for (int x = 0; x + size.width <= picture.size.width; ++x)
        if (is_text_at(picture, x, y, text, scale)) return true;
  }
  return false;
}

class ScreenTest : public ::testing::Test {
 protected:
  ScreenTest() {
    auto large = made_composite();
    large->images.color.reset({640, 360}, {60, 70, 80});
    large->images.matte.reset({640, 360}, 90);
    composite_ = large;
    facts_.live = true;
    facts_.rate_hz = 25;
    facts_.age = 60ms;
  }
  ImageView<const Rgbx8> draw() {
    const auto picture = screen_.draw(composite_.get(), state_, facts_).picture;
    keep(picture);
    return picture;
  }
  /// Saves the picture as a PNG for inspection if MIXRIG_KEEP names a folder.
  static void keep(ImageView<const Rgbx8> picture) {
    const char* const folder = std::getenv("MIXRIG_KEEP");
    if (folder == nullptr) return;
    Image<Rgb8> out(picture.size);
    for (int y = 0; y < picture.size.height; ++y)
      for (int x = 0; x < picture.size.width; ++x) {
        const Rgbx8 p = picture.row(y)[x];
        out.row(y)[x] = {p.r, p.g, p.b};
      }
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    (void)image_io::write_png(std::filesystem::path(folder) / (std::string(test->name()) + ".png"),
                              out.view());
  }
  bool untouched(ImageView<const Rgbx8> picture) const {
    for (int y = 0; y < picture.size.height; ++y)
      for (int x = 0; x < picture.size.width; ++x) {
        const Rgbx8 p = picture.row(y)[x];
        if (p.r != 60 || p.g != 70 || p.b != 80) return false;
      }
    return true;
  }
  std::shared_ptr<output::Composite> composite_;
  Screen screen_;
  ViewState state_;
  ScreenFacts facts_;
};

TEST_F(ScreenTest, ALivePictureIsTheCompositeAndNothingElse) {
  EXPECT_TRUE(untouched(draw()));
  facts_.age = 4s;  // poses that need what comes after: late, and yet every picture is new
  EXPECT_TRUE(untouched(draw()));
}

TEST_F(ScreenTest, BeforeTheFirstPictureItSaysSo) {
  composite_.reset();
  facts_.age.reset();
  EXPECT_TRUE(reads(draw(), "waiting for the first picture"));
}

TEST_F(ScreenTest, AStalePictureHasItsAgeWrittenOverIt) {
  facts_.since_last = 1200ms, facts_.age = 1260ms;
  facts_.fault.set("camera 'color' (fake:) is lost");
  const auto picture = draw();
  EXPECT_TRUE(reads(picture, "LAST PICTURE, 1.3 s OLD"));
  EXPECT_TRUE(reads(picture, "camera 'color' (fake:) is lost"));
  EXPECT_EQ(picture.at(100, 100).r, 60) << "the picture is still seen";
}

TEST_F(ScreenTest, APictureThatIsTooOldIsNotShown) {
  facts_.since_last = 12s, facts_.age = 12s;
  facts_.fault.set("camera 'color' (fake:) is lost");
  const auto picture = draw();
  EXPECT_TRUE(reads(picture, "NO PICTURE FOR 12 s"));
  EXPECT_TRUE(reads(picture, "camera 'color' (fake:) is lost"));
  int seen = 0;
  for (int y = 0; y < picture.size.height; ++y)
    for (int x = 0; x < picture.size.width; ++x) seen += picture.row(y)[x].g == 70 ? 1 : 0;
  EXPECT_EQ(seen, 0) << "pixels of the composite";
}

TEST_F(ScreenTest, AFrozenPictureSaysSoWhateverElseIsShown) {
  state_.frozen = true, facts_.age = 2500ms;
  for (const View view : {View::kComposite, View::kMatte}) {
    state_.view = view;
    EXPECT_TRUE(reads(draw(), "FROZEN, 2.5 s OLD"));
  }
}

TEST_F(ScreenTest, DepthThatIsLostIsNamedInThePicture) {
  facts_.without_depth = 3200ms;
  EXPECT_TRUE(reads(draw(), "NO DEPTH FOR 3.2 s: PEOPLE ARE NOT KEYED"));
}

TEST_F(ScreenTest, ALostPoseIsNamedUnlessTheOverlayIsOff) {
  composite_->pose.loss = capture::PoseLoss::kTooOld;
  composite_->objects_shown = false;
  EXPECT_TRUE(reads(draw(), "POSE LOST (too_old): OBJECTS HIDDEN"));
  state_.overlays[static_cast<std::size_t>(Overlay::kPose)] = false;
  EXPECT_TRUE(untouched(draw()));
}

TEST_F(ScreenTest, RateDelaySyncRecordingMessageAndView) {
  for (const Overlay overlay : {Overlay::kRate, Overlay::kDelay, Overlay::kSync})
    state_.overlays[static_cast<std::size_t>(overlay)] = true;
  state_.view = View::kMatte;
  facts_.shown_hz = 24.96, facts_.delay = 47300us, facts_.recording = true;
  facts_.sync[1].set("depth: 25.0 frames a second");
  facts_.message.set("recording");
  const auto picture = draw();
  for (const char* text : {"25.0 pictures per second", "delay 47 ms", "REC", "matte",
                           "depth: 25.0 frames a second", "recording"})
    EXPECT_TRUE(reads(picture, text)) << text;
}

TEST_F(ScreenTest, TheHelpFitsIntoASmallPicture) {
  state_.overlays[static_cast<std::size_t>(Overlay::kHelp)] = true;
  const auto picture = draw();
  for (const KeyHelp& key : kKeys) EXPECT_TRUE(reads(picture, std::string(key.what))) << key.what;
}

TEST_F(ScreenTest, AnImageThatTheFrameLacksIsNamed) {
  composite_->images.wanted = render::kColor | render::kMatte;
  state_.view = View::kKey;
  EXPECT_TRUE(reads(draw(), "no key in this frame"));
}

TEST_F(ScreenTest, DrawsAllOfItAgainWithoutAllocating) {
  state_.overlays.fill(true);
  facts_.message.set("recording"), facts_.fault.set("lost"), facts_.sync[0].set("sets");
  facts_.without_depth = 1s;
  composite_->pose.loss = capture::PoseLoss::kGap;
  for (const View view : {View::kMatte, View::kComposite}) {
    state_.view = view;
    draw();
    const long before = test::allocations;
    for (int i = 0; i < 5; ++i) (void)screen_.draw(composite_.get(), state_, facts_);
    EXPECT_EQ(test::allocations - before, 0) << name(view);
  }
}

/// A composite that was not read back.
class OverGpu : public ScreenTest {
 protected:
  class Picture final : public render::GpuPicture {
   public:
    Size size_px() const override { return {640, 360}; }
    Result<void> copy_to_bound_texture() const override { return {}; }
  };
  OverGpu() {
    auto there = made_composite();
    there->images = {};
    there->images.wanted = render::kGpuColor;
    there->images.gpu_color = picture_;
    composite_ = there;
  }
  Drawn draw() { return screen_.draw(composite_.get(), state_, facts_); }
  static int covered(const Drawn& drawn) {
    int count = 0;
    for (int y = 0; y < drawn.picture.size.height; ++y)
      for (int x = 0; x < drawn.picture.size.width; ++x) count += drawn.picture.at(x, y).x > 0;
    return count;
  }
  const std::shared_ptr<const Picture> picture_ = std::make_shared<Picture>();
};

TEST_F(OverGpu, NothingIsDrawnWhereNothingIsToBeSaid) {
  const Drawn drawn = draw();
  EXPECT_EQ(drawn.below, picture_.get());
  EXPECT_TRUE(drawn.is_empty);
  EXPECT_EQ(covered(drawn), 0);
}

TEST_F(OverGpu, LinesCoverHalfAndTextAll) {
  state_.overlays[static_cast<std::size_t>(Overlay::kGuides)] = true;
  const Drawn guides = draw();
  EXPECT_FALSE(guides.is_empty);
  const Rgbx8 line = guides.picture.at(5, 360 / 3);
  EXPECT_EQ(line.x, 127) << "the share of the line, whose light is multiplied by it";
  EXPECT_EQ(line.r, 127);
  EXPECT_EQ(guides.picture.at(5, 7).x, 0);
  facts_.message.set("{}", "recording");
  EXPECT_TRUE(reads(draw().picture, "recording"));
}

TEST_F(OverGpu, WhatIsOldIsMarkedThenTakenAway) {
  facts_.since_last = 1s;
  const Drawn stale = draw();
  EXPECT_EQ(stale.below, picture_.get());
  EXPECT_FALSE(stale.is_empty);
  EXPECT_EQ(stale.picture.at(0, 0).x, 255);
  facts_.since_last = 10s;
  const Drawn gone = draw();
  EXPECT_EQ(gone.below, nullptr);
  EXPECT_EQ(covered(gone), 640 * 360);
}

TEST_F(OverGpu, AnotherViewHasItsOwnImage) {
  state_.view = View::kPlate;
  EXPECT_EQ(draw().below, nullptr);
}

}  // namespace
}  // namespace mixrig::viewfinder

// SPDX-License-Identifier: Apache-2.0
// Changes of [focus] and [background] leave the other text as it is.
#include "host/scene/settings_edit.h"

#include <gtest/gtest.h>

#include "host/scene/scene_manifest.h"

namespace mixrig::scene {
namespace {

const std::filesystem::path kPath = "/somewhere/scene.toml";

Scene read(const Result<std::string>& text) {
  EXPECT_TRUE(text) << (text ? "" : to_line(text.error()));
  auto scene = parse_scene(text ? *text : "", kPath, false);
  EXPECT_TRUE(scene);
  return scene ? *std::move(scene) : Scene{};
}

TEST(FocusEdit, ADistanceTakesThePlaceOfAPixelAndBack) {
  const std::string text =
      "# ours\n[focus]\ndistance_m = 2.5  # the door\nf_number = 2.0\n\n"
      "[light]\nambient = [0.5, 0.5, 0.5]\n";
  const auto by_pixel = with_focus(text, kPath, {{}, std::pair(12, 34), {}});
  const Scene seen = read(by_pixel);
  EXPECT_EQ(seen.focus->pixel, std::pair(12, 34));
  EXPECT_EQ(seen.focus->f_number, 2.0);
  EXPECT_TRUE(by_pixel->starts_with("# ours\n[focus]\n"));
  EXPECT_TRUE(by_pixel->ends_with("\n\n[light]\nambient = [0.5, 0.5, 0.5]\n")) << *by_pixel;
  const Scene back = read(with_focus(*by_pixel, kPath, {3.25, {}, 1.4}));
  EXPECT_EQ(back.focus->distance_m, 3.25);
  EXPECT_FALSE(back.focus->pixel);
  EXPECT_EQ(back.focus->f_number, 1.4);
}

TEST(FocusEdit, ANewOneNeedsToKnowWhatIsSharp) {
  const std::string text = "[camera]\npose = \"identity\"\n";
  EXPECT_EQ(with_focus(text, kPath, {{}, {}, 2.0}).error().code, ErrorCode::kUsage);
  const auto made = with_focus(text, kPath, {1.5, {}, 2.0});
  EXPECT_EQ(read(made).focus->distance_m, 1.5);
  EXPECT_TRUE(made->starts_with(text));
  EXPECT_EQ(without_focus(*made, kPath).value(), text + "\n");
}

TEST(FocusEdit, ItsRungGoesWithIt) {
  const std::string text =
      "[quality]\nkey = \"votes\"\nfocus = \"fast\"\n\n[focus]\ndistance_m = 2.5\n";
  const Scene left = read(without_focus(text, kPath));
  EXPECT_FALSE(left.focus || left.quality.focus);
  EXPECT_EQ(left.quality.key, KeyRung::kVotes);
}

TEST(FocusEdit, WhatCannotBeWrittenIsRefused) {
  EXPECT_EQ(with_focus("focus = {distance_m = 2.0}\n", kPath, {1.5, {}, {}}).error().code,
            ErrorCode::kFormat);
  EXPECT_EQ(without_focus("focus = {distance_m = 2.0}\n", kPath).error().code, ErrorCode::kFormat);
  EXPECT_EQ(with_focus("[focus]\ndistance_m = 2.0\n", kPath, {{}, {}, 1000}).error().code,
            ErrorCode::kFormat)
      << "out of its range";
  EXPECT_FALSE(with_focus("[focus\n", kPath, {1.5, {}, {}}));
}

TEST(BackgroundEdit, AModelTakesThePlaceOfLearnedFrames) {
  const std::string text = "[background]  # empty room\nlearn = [1, 25]\nwalls = \"open\"\n";
  const auto edited = with_background_model(text, kPath, "rooms/room 1");
  const Scene scene = read(edited);
  EXPECT_EQ(scene.background.model, "/somewhere/rooms/room 1");
  EXPECT_FALSE(scene.background.learn);
  EXPECT_TRUE(scene.background.open_walls);
  EXPECT_TRUE(edited->starts_with("[background]  # empty room\n"));
  EXPECT_EQ(read(with_background_model("", kPath, "r")).background.model, "/somewhere/r");
  EXPECT_EQ(with_background_model("background = {learn = [1, 2]}\n", kPath, "r").error().code,
            ErrorCode::kFormat);
}

}  // namespace
}  // namespace mixrig::scene

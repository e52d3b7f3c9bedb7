// SPDX-License-Identifier: Apache-2.0
// [quality] of scene.toml.
#include <gtest/gtest.h>

#include "host/scene/scene_changes.h"
#include "host/scene/scene_manifest.h"

namespace mixrig::scene {
namespace {

Result<Scene> parse(const std::string& text) { return parse_scene(text, "s/scene.toml", false); }

Rungs rungs(const std::string& text) {
  const auto scene = parse(text);
  EXPECT_TRUE(scene) << scene.error().context;
  return scene ? rungs_of(*scene) : Rungs{};
}

std::string refusal(const std::string& text) {
  const auto scene = parse(text);
  EXPECT_FALSE(scene) << text;
  return scene ? "" : scene.error().context;
}

TEST(QualityTable, RungsAreTheBestWhereItIsAbsent) {
  EXPECT_EQ(rungs(""), Rungs{});
  const std::string volume = "[camera]\ncapture_volume = {min_m = [0, 0, 0], max_m = [1, 1, 1]}\n";
  EXPECT_EQ(rungs(volume + "[set]\nmodel = \"court.glb\"").light, LightRung::kPeople);
  EXPECT_EQ(rungs(volume + "[set]\npicture = \"sky.png\"").light, LightRung::kShadows)
      << "a set without a model receives none";
}

TEST(QualityTable, NamesARungOfEachStage) {
  EXPECT_EQ(rungs("[quality]\nkey = \"plain\"\nlight = \"people\"\nfocus = \"fast\"\n"
                  "[focus]\ndistance_m = 2"),
            (Rungs{KeyRung::kPlain, LightRung::kPeople, FocusRung::kFast}));
  EXPECT_EQ(rungs("[quality]\nkey = \"votes\"\nlight = \"plain\""),
            (Rungs{KeyRung::kVotes, LightRung::kPlain, FocusRung::kFine}));
  EXPECT_EQ(parse("[quality]\nbudget_ms = 16.6")->quality.budget_ms, 16.6);
}

TEST(QualityTable, WhatIsWrongIsOneLine) {
  const std::string unknown = refusal("[quality]\nkey = \"best\"");
  EXPECT_NE(unknown.find("s/scene.toml:2"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("\"plain\", \"votes\", \"refined\""), std::string::npos) << unknown;
  EXPECT_NE(refusal("[quality]\nbudget_ms = 0").find("budget_ms"), std::string::npos);
  EXPECT_NE(refusal("[quality]\nfocus = \"fast\"").find("[focus]"), std::string::npos);
  EXPECT_NE(refusal("[quality]\nwarp = \"fast\"").find("warp"), std::string::npos);
}

TEST(QualityTable, KeysOfEarlierVersionsAreOneLineThatSaysWhatToWrite) {
  const struct {
    const char *text, *where, *instead;
  } kCases[] = {{"[key]\nthreshold_m = 0.1\ncolor = true", "s/scene.toml:3", "key = \"refined\""},
                {"[key]\ncolor = false\nrefine = true", "s/scene.toml:2", "key = \"plain\""},
                {"[key]\nrefine = false", "s/scene.toml:2", "key = \"votes\""},
                {"[light]\npeople_cast = false", "s/scene.toml:2", "light = \"shadows\""},
                {"[light]\npeople_cast = true", "s/scene.toml:2", "light = \"people\""},
                {"[focus]\ndistance_m = 2\nrung = \"fast\"", "s/scene.toml:3", "focus = \"fast\""}};
  for (const auto& c : kCases) {
    const std::string line = refusal(c.text);
    EXPECT_NE(line.find(c.where), std::string::npos) << line;
    EXPECT_NE(line.find(c.instead), std::string::npos) << line;
  }
}

TEST(QualityTable, ABudgetIsTakenAtTheStart) {
  const auto with = parse("[quality]\nbudget_ms = 20"), without = parse("");
  ASSERT_TRUE(with && without);
  EXPECT_EQ(fixed_changes(*without, *with), "quality.budget_ms");
  EXPECT_EQ(fixed_changes(*with, *with), "");
}

}  // namespace
}  // namespace mixrig::scene

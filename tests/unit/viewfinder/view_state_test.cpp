// SPDX-License-Identifier: Apache-2.0
#include "host/output/viewfinder/view_state.h"

#include <gtest/gtest.h>

namespace mixrig::viewfinder {
namespace {

using namespace std::chrono_literals;

TEST(ViewStateTest, DigitsChooseTheView) {
  ViewState state;
  const View views[] = {View::kComposite, View::kPlate, View::kKey,
                        View::kDepth,     View::kLight, View::kMatte};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(press(static_cast<char>('1' + i), state), Request::kNone);
    EXPECT_EQ(state.view, views[i]);
  }
  EXPECT_EQ(press('7', state), Request::kNone);
  EXPECT_EQ(press('0', state), Request::kNone);
  EXPECT_EQ(state.view, View::kMatte) << "there is no seventh";
}

TEST(ViewStateTest, EachOverlayHasItsKeyAndOnlyThePoseIsWatchedFromTheStart) {
  const std::pair<char, Overlay> keys[] = {{'f', Overlay::kRate},   {'d', Overlay::kDelay},
                                           {'s', Overlay::kSync},   {'p', Overlay::kPose},
                                           {'z', Overlay::kZebra},  {'x', Overlay::kPeaking},
                                           {'g', Overlay::kGuides}, {'h', Overlay::kHelp}};
  for (const auto& [key, overlay] : keys) {
    ViewState state;
    EXPECT_EQ(state.on(overlay), overlay == Overlay::kPose);
    EXPECT_EQ(press(key, state), Request::kNone);
    EXPECT_EQ(state.on(overlay), overlay != Overlay::kPose) << key;
    press(key, state);
    EXPECT_EQ(state.on(overlay), overlay == Overlay::kPose) << key;
  }
}

TEST(ViewStateTest, WhatTheRunTellsIsNewsOnce) {
  ViewState state;
  output::RunState run;
  EXPECT_FALSE(follow(run, state).any());
  run.view = View::kMatte, run.frozen = true;
  run.placements = 1, run.placed = output::Placement::kNoSurface;
  const RunNews news = follow(run, state);
  EXPECT_TRUE(news.view && news.frozen);
  EXPECT_EQ(news.placed, output::Placement::kNoSurface);
  EXPECT_EQ(state.view, View::kMatte);
  EXPECT_TRUE(state.frozen);
  EXPECT_FALSE(follow(run, state).any());
}

TEST(ViewStateTest, OtherKeysAskTheRun) {
  ViewState state;
  EXPECT_EQ(press('b', state), Request::kLearn);
  EXPECT_EQ(press('r', state), Request::kRecord);
  EXPECT_EQ(press('q', state), Request::kQuit);
  EXPECT_EQ(press(kEscape, state), Request::kLeave);
  EXPECT_EQ(press(kWindowClosed, state), Request::kQuit);
  EXPECT_EQ(press(kFullScreenKey, state), Request::kFullScreen);
  EXPECT_FALSE(state.frozen);
  EXPECT_EQ(press(' ', state), Request::kNone);
  EXPECT_TRUE(state.frozen);
  for (const char key : {'y', '\0', '~'}) EXPECT_EQ(press(key, state), Request::kNone);
}

TEST(ViewStateTest, TheHelpNamesEveryKeyOnce) {
  for (const KeyHelp& help : kKeys) {
    EXPECT_EQ(std::count_if(kKeys.begin(), kKeys.end(),
                            [&](const KeyHelp& other) { return other.key == help.key; }),
              1);
    ViewState state{.view = View::kMatte, .overlays = {}, .frozen = false};
    if (help.key == '6') state.view = View::kPlate;
    const ViewState before = state;
    const Request request = press(help.key, state);
    EXPECT_TRUE(request != Request::kNone || state.view != before.view ||
                state.overlays != before.overlays || state.frozen != before.frozen)
        << help.what;
  }
}

TEST(FreshnessTest, StaleAndGoneComeAfterStatedTimes) {
  EXPECT_EQ(freshness(299ms, 25), Freshness::kLive);
  EXPECT_EQ(freshness(300ms, 25), Freshness::kStale);
  EXPECT_EQ(freshness(4999ms, 25), Freshness::kStale);
  EXPECT_EQ(freshness(5s, 25), Freshness::kGone);
  EXPECT_EQ(freshness(5s, 0), Freshness::kGone);
  EXPECT_EQ(freshness(1400ms, 2), Freshness::kLive) << "a slow camera";
  EXPECT_EQ(freshness(1500ms, 2), Freshness::kStale);
}

}  // namespace
}  // namespace mixrig::viewfinder

// SPDX-License-Identifier: Apache-2.0
// A wall 4 m away in the frames, and backgrounds in which somebody stood before a part of it.
#include "host/room/background/seen_through.h"

#include <gtest/gtest.h>

namespace mixrig::model {
namespace {

struct GhostRoom {
  explicit GhostRoom(int ghost_columns) : depth_m({160, 120}, 4.0F) {
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < ghost_columns; ++x) depth_m.row(y)[40 + x] = 2.0F;
    setup.target.pinhole = setup.view = {{160, 120}, 140, 140, 79.5, 59.5};
    setup.tof.pinhole = {{100, 80}, 80, 80, 49.5, 39.5};
    setup.target_from_tof.translation_m = {0.1, 0, 0};
    setup.background.depth_m = depth_m.view();
  }
  Image<float> depth_m;
  render::CompositorSetup setup;
};

/// Frames of 30 Hz of a wall with somebody 2 m away in the first columns.
std::optional<double> share_after_a_second(const GhostRoom& room, int person_columns,
                                           int from_column = 0) {
  SeenThrough seen(room.setup);
  capture::Capture frame;
  frame.depth_m = Image<float>(Size{100, 80}, 4.0F);
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < person_columns; ++x) frame.depth_m.row(y)[from_column + x] = 2.0F;
  std::optional<double> share;
  for (int i = 0; i < 40; ++i) {
    frame.time_s = 7 + i / 30.0;
    const auto told = seen.add(frame);
    EXPECT_FALSE(told && share) << "told once";
    EXPECT_FALSE(told && i < 29) << i;
    if (told) share = told;
  }
  return share;
}

TEST(SeenThrough, SomebodyInTheBackgroundWhoHasLeftIsFoundBySize) {
  const auto share = share_after_a_second(GhostRoom(32), 0);
  ASSERT_TRUE(share);
  EXPECT_NEAR(*share, 32.0 / 160, 0.03) << "of the cells";
}

TEST(SeenThrough, APersonWhoComesOrABackgroundThatIsEmptyIsNothing) {
  EXPECT_EQ(share_after_a_second(GhostRoom(0), 0), 0.0);
  EXPECT_EQ(share_after_a_second(GhostRoom(0), 40), 0.0);
}

/// The depth camera sees past the column in the room, to which the person in the frames is nothing.
TEST(SeenThrough, WhatStillStandsThereIsNoGhostInSpiteOfTheParallax) {
  // View columns 40 to 72 at 2 m are x = -0.564 to -0.107 m, depth columns 23 to 41.
  EXPECT_EQ(share_after_a_second(GhostRoom(32), 20, 22), 0.0);
}

}  // namespace
}  // namespace mixrig::model

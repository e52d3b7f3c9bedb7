// SPDX-License-Identifier: Apache-2.0
#include "host/capture/sync/pan_tilt_track.h"

#include <gtest/gtest.h>

namespace mixrig::sync {
namespace {

using namespace std::chrono_literals;

HostTime at(Duration t) { return HostTime(t); }

TEST(PanTiltTrack, InterpolatesEachAxisByItsOwnTimes) {
  PanTiltTrack track;
  track.add({{0.0, 1.0}, at(100ms), at(110ms)});
  track.add({{0.2, 0.0}, at(200ms), at(210ms)});
  const auto angles = track.at(at(150ms));
  ASSERT_TRUE(angles);
  EXPECT_NEAR(angles->pan_rad, 0.1, 1e-12);
  EXPECT_NEAR(angles->tilt_rad, 0.6, 1e-12);
}

TEST(PanTiltTrack, DoesNotGuessWhereAMovingHeadIs) {
  PanTiltTrack track;
  EXPECT_FALSE(track.at(at(0ms)));
  track.add({{0.0, 0.0}, at(100ms), at(100ms)});
  track.add({{0.2, 0.0}, at(200ms), at(200ms)});
  EXPECT_FALSE(track.at(at(99ms)));
  EXPECT_TRUE(track.at(at(200ms)));
  EXPECT_FALSE(track.at(at(201ms)));
}

TEST(PanTiltTrack, AUnitThatDidNotAnswerForLongLeavesTheTimeBetweenUnknown) {
  PanTiltTrack track;
  for (const auto& [t, rad] : {std::pair(0ms, 0.0), {50ms, 0.01}, {1050ms, 0.4}, {1100ms, 0.41}})
    track.add({{rad, rad}, at(t), at(t)});
  EXPECT_FALSE(track.at(at(51ms)));
  EXPECT_FALSE(track.at(at(1049ms)));
  EXPECT_NEAR(track.at(at(50ms))->pan_rad, 0.01, 1e-12);
  EXPECT_NEAR(track.at(at(1075ms))->pan_rad, 0.405, 1e-12);
}

TEST(PanTiltTrack, AHeadThatStandsStillStaysThereForAWhile) {
  PanTiltTrack track;
  for (int i = 0; i < 200; ++i) track.add({{0.2, 0.1}, at(i * 50ms), at(i * 50ms)});
  EXPECT_NEAR(track.at(at(9950ms + 400ms))->pan_rad, 0.2, 1e-12);
  EXPECT_FALSE(track.at(at(9950ms + 600ms)));
  EXPECT_FALSE(track.at(at(3000ms))) << "older than what is kept";
}

TEST(PanTiltTrack, AUnitThatAnswersOftenIsKnownSomeFramesBack) {
  PanTiltTrack track;
  for (int i = 0; i < 20000; ++i) {
    const auto time = HostTime(std::chrono::microseconds(100) * i);
    const double rad = 0.001 * std::min(500, i / 20);  // a step each 2 ms for a second
    track.add({{rad, -0.5}, time, time});
  }
  const auto back = track.at(HostTime(std::chrono::milliseconds(1999 - 300)));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->pan_rad, 0.5);
  EXPECT_EQ(back->tilt_rad, -0.5);
}

}  // namespace
}  // namespace mixrig::sync

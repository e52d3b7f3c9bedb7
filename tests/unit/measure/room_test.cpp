// SPDX-License-Identifier: Apache-2.0
// Rooms whose distances have a formula.
#include "host/judge/measure/room.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

constexpr Size kSize{720, 360};

/// An empty room, seen from axes that are turned by 90 degrees about z: +y of the axes is -x.
RoomFrame frame_of() { return {{5, 4, 3}, {2, 1.5, 1.2}, {0, -1, 0, 1, 0, 0, 0, 0, 1}}; }

/// Distance to the walls of a room of other inner dimensions whose corner is moved by `shift_m`.
Image<float> room_picture(const RoomFrame& frame, const std::array<double, 3>& inner_m,
                          double shift_m = 0) {
  Image<float> picture(kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const double azimuth = M_PI - 2 * M_PI * (x + 0.5) / kSize.width;
      const double elevation = M_PI / 2 - M_PI * (y + 0.5) / kSize.height;
      const double right = -std::sin(azimuth) * std::cos(elevation);
      const double ahead = std::cos(azimuth) * std::cos(elevation);
      const std::array<double, 3> ray{-ahead, right, std::sin(elevation)};
      double nearest = 1e9;
      for (std::size_t k = 0; k < 3; ++k) {
        const double wall = ray[k] > 0 ? inner_m[k] + shift_m : shift_m;
        if (ray[k] != 0) nearest = std::min(nearest, (wall - frame.origin_m[k]) / ray[k]);
      }
      picture.at(x, y) = static_cast<float>(nearest);
    }
  return picture;
}

TEST(RoomErrors, AreZeroOfTheTruthItself) {
  const RoomFrame frame = frame_of();
  const Image<float> truth = room_picture(frame, frame.inner_m);
  const RoomErrors errors = room_errors(truth.view(), truth.view(), frame, 100);
  for (const WallToWall& axis : errors.axes) {
    EXPECT_EQ(axis.count, 100);
    EXPECT_EQ(axis.max_mm, 0);
  }
  EXPECT_EQ(errors.p95_mm, 0);
  EXPECT_EQ(errors.points, 720U * 359U);
}

TEST(RoomErrors, SayByHowMuchEachLengthIsWrong) {
  const RoomFrame frame = frame_of();
  const Image<float> truth = room_picture(frame, frame.inner_m);
  const Image<float> model = room_picture(frame, {5.010, 3.996, 3.002});
  const RoomErrors errors = room_errors(model.view(), truth.view(), frame, 100);
  // A length is measured between rays, not at right angles to the wall: the error of a ray's end
  // along the axis is that of the wall.
  EXPECT_NEAR(errors.axes[0].mean_mm, 10, 0.05);
  EXPECT_NEAR(errors.axes[1].mean_mm, 4, 0.05);
  EXPECT_NEAR(errors.axes[2].mean_mm, 2, 0.05);
  EXPECT_NEAR(errors.axes[0].max_mm, 10, 0.1);
  EXPECT_NEAR(errors.axes[1].p95_mm, 4, 0.1);
  EXPECT_NEAR(errors.p95_mm, 10, 0.1);
}

TEST(RoomErrors, AShiftedRoomHasRightLengthsButItsSurfaceIsOff) {
  const RoomFrame frame = frame_of();
  const Image<float> truth = room_picture(frame, frame.inner_m);
  const Image<float> model = room_picture(frame, frame.inner_m, 0.025);
  const RoomErrors errors = room_errors(model.view(), truth.view(), frame, 100);
  for (const WallToWall& axis : errors.axes) EXPECT_LT(axis.max_mm, 0.05);
  EXPECT_NEAR(errors.p50_mm, 25, 0.1);
  EXPECT_GT(errors.over_20mm_pct, 95);
}

TEST(RoomErrors, MeasureOnlyWhereWallsAreFreeAndKnown) {
  const RoomFrame frame = frame_of();
  Image<float> truth = room_picture(frame, frame.inner_m);
  Image<float> model = truth;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width / 2; ++x) {
      truth.at(x, y) -= 0.3F;  // furniture all over the left half, which the model does not hold
      if (y > 180) model.at(x, y) = 0;
    }
  const RoomErrors errors = room_errors(model.view(), truth.view(), frame, 20);
  for (const WallToWall& axis : errors.axes) EXPECT_EQ(axis.max_mm, 0);
  EXPECT_EQ(errors.axes[1].count, 0);  // its walls are left and right
  EXPECT_EQ(errors.axes[2].count, 20);
  EXPECT_NEAR(errors.over_20mm_pct, 100.0 / 3, 1);
}

}  // namespace
}  // namespace mixrig::measure

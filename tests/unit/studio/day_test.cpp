// SPDX-License-Identifier: Apache-2.0
// Another day than that of the scan: a crowd, lamps that go off, a door that swings, a moved chair;
// and the mirror in the fisheye.
#include "studio/day.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "studio/stage/layout.h"
#include "studio/studio.h"

namespace mixrig::studio {
namespace {

StudioOptions fisheye_options() {
  StudioOptions o;
  o.scenario = Scenario::kHandheld;
  o.rig = RigPreset::kKinect2;
  o.seed = 5;
  o.frames = 200;
  o.size_px = {32, 32};
  o.threads = 1;
  o.fisheye = true;
  o.fisheye_px = {160, 128};
  return o;
}

FisheyePicture picture_at(const StudioOptions& options, int number) {
  auto studio = Studio::create(options);
  EXPECT_TRUE(studio) << studio.error().context;
  FisheyePicture out;
  studio->render_fisheye(number, out);
  return out;
}

double brightness(const Image<Rgb8>& picture) {
  double sum = 0;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) sum += picture.at(x, y).g;
  return sum / picture.width() / picture.height();
}

/// Share of the pixels that differ by more than noise does.
double changed(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  int count = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) count += std::abs(a.at(x, y).g - b.at(x, y).g) > 20 ? 1 : 0;
  return static_cast<double>(count) / a.width() / a.height();
}

TEST(Day, ACrowdCoversHalfOfTheFisheye) {
  StudioOptions options = fisheye_options();
  const FisheyePicture alone = picture_at(options, 20);
  options.day.crowd = 8;
  const FisheyePicture crowd = picture_at(options, 20);
  EXPECT_LT(alone.people_share, 0.1);
  EXPECT_GT(crowd.people_share, 0.4);
  EXPECT_NEAR(changed(alone.picture, crowd.picture), crowd.people_share - alone.people_share, 0.25);
  EXPECT_EQ(picture_at(options, 2).people_share, 0) << "before they come";
}

TEST(Day, LampsGoOffInMidTake) {
  StudioOptions options = fisheye_options();
  const double lit = brightness(picture_at(options, 12).picture);
  options.day.lights_out_s = 1.5;
  EXPECT_EQ(brightness(picture_at(options, 12).picture), lit);
  EXPECT_LT(brightness(picture_at(options, 20).picture), 0.5 * lit);
  auto studio = Studio::create(options);
  ASSERT_TRUE(studio);
  FisheyePicture picture;
  studio->render_fisheye(20, picture);
  studio->render_fisheye(12, picture);
  EXPECT_EQ(brightness(picture.picture), lit) << "earlier times are lit again";
  options.day.lights_out_s.reset(), options.day.lamp_level = 0.5;
  const double dimmed = brightness(picture_at(options, 12).picture);
  EXPECT_LT(dimmed, 0.85 * lit);
  EXPECT_GT(dimmed, 0.5 * lit);
}

TEST(Day, ADoorSwingsAndClosesAgain) {
  Day day;
  EXPECT_EQ(door_rad(day, 3), 0);
  day.swinging_door = true;
  EXPECT_EQ(door_rad(day, 0), 0);
  EXPECT_NEAR(door_rad(day, 3), 75 * 3.14159265 / 180, 1e-5);
  EXPECT_NEAR(door_rad(day, 6), 0, 1e-6);
  StudioOptions options = fisheye_options();
  const FisheyePicture closed = picture_at(options, 31);
  options.day.swinging_door = true;
  const FisheyePicture open = picture_at(options, 31);
  const double share = changed(closed.picture, open.picture);
  EXPECT_GT(share, 0.005);
  EXPECT_LT(share, 0.1);
}

TEST(Day, AMovedChairChangesALittle) {
  StudioOptions options = fisheye_options();
  const FisheyePicture before = picture_at(options, 3);
  options.day.moved_chair = true;
  const FisheyePicture after = picture_at(options, 3);
  const double share = changed(before.picture, after.picture);
  EXPECT_GT(share, 0.001);
  EXPECT_LT(share, 0.05);
  options.clear_floor = true;
  EXPECT_FALSE(Studio::create(options));
}

TEST(Day, TheFisheyeSeesTheRoomInTheMirror) {
  StudioOptions options = fisheye_options();
  options.realism.mirror = true;
  // The mirror hangs at y 1.8 to 2.75, z 0.95 to 2.05 of the far wall: half a metre before it.
  options.eye_m = Eigen::Vector3d(4.6, 2.3, 1.5),
  options.look_at_m = Eigen::Vector3d(5.2, 2.3, 1.5);
  const FisheyePicture picture = picture_at(options, 2);
  double sum = 0, squares = 0;
  constexpr int kHalf = 12;
  for (int y = 64 - kHalf; y < 64 + kHalf; ++y)
    for (int x = 80 - kHalf; x < 80 + kHalf; ++x) {
      const double v = picture.picture.at(x, y).g;
      sum += v, squares += v * v;
    }
  const double n = 4.0 * kHalf * kHalf, mean = sum / n;
  EXPECT_GT(mean, 60);
  EXPECT_GT(std::sqrt(squares / n - mean * mean), 10) << "it shows a room, not a colour";
}

TEST(Day, RefusesWhatCannotBe) {
  for (const int crowd : {-1, 9}) {
    StudioOptions options = fisheye_options();
    options.day.crowd = crowd;
    EXPECT_FALSE(Studio::create(options));
  }
  StudioOptions options = fisheye_options();
  options.day.lamp_level = std::nan("");
  EXPECT_FALSE(Studio::create(options));
}

}  // namespace
}  // namespace mixrig::studio

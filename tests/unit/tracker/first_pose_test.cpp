// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/first_pose.h"

#include <random>

#include <gtest/gtest.h>

#include "host/pose/tracker/tracker.h"
#include "tests/support/textured_box.h"

namespace mixrig::tracking {
namespace {

using test::in_the_box;
using test::TexturedBox;

struct SearchBench {
  explicit SearchBench(const TexturedBox& box = TexturedBox())
      : room(box.panorama()), first(room, map, camera, {}, crew) {}

  std::optional<PatchFit> find(const Image<Rgb8>& picture) {
    GreyPyramid pyramid;
    pyramid.build(picture, 6, crew);
    return first.find(pyramid, {looking_ahead(), 0.8, 0.9});
  }

  Crew crew{2};
  model::Panorama room;
  geometry::AnyCamera camera = TexturedBox::camera();
  PatchMap map = make_patch_map(room, {0.009, 6, 1500}, crew);
  FirstPose first;
};

TEST(FirstPose, FindsPosesAnywhereInItsField) {
  SearchBench bench;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto within = [&](double radius) {
    Eigen::Vector3d v;
    do v = {unit(random), unit(random), unit(random)};
    while (v.norm() > 1);
    return Eigen::Vector3d(radius * v);
  };
  for (int i = 0; i < 6; ++i) {
    const geometry::Pose truth = in_the_box(within(0.75), within(0.85));
    const auto fit = bench.find(TexturedBox().picture(truth, 2, static_cast<unsigned>(i) + 1));
    ASSERT_TRUE(fit) << i;
    const geometry::Pose found = geometry::inverse(fit->camera_from_room);
    EXPECT_LT((found.translation_m - truth.translation_m).norm(), 0.003) << i;
    EXPECT_LT(found.rotation.angularDistance(truth.rotation), 0.001) << i;
  }
}

TEST(FirstPose, WallsThatRepeatAreFoundRightOrNotAtAll) {
  const TexturedBox box(3, 1, 0.5);
  SearchBench bench(box);
  int found = 0;
  for (int i = 0; i < 4; ++i) {
    const geometry::Pose truth = in_the_box({0.3 * i - 0.5, 0.2, 0.1 * i}, {0.1 * i, 0, 0.2});
    const auto fit = bench.find(box.picture(truth, 2, static_cast<unsigned>(i) + 1));
    if (!fit) continue;
    ++found;
    const geometry::Pose pose = geometry::inverse(fit->camera_from_room);
    EXPECT_LT((pose.translation_m - truth.translation_m).norm(), 0.005) << i;
  }
  EXPECT_GE(found, 1);
}

TEST(FirstPose, AnotherRoomAndACoveredLensHaveNone) {
  SearchBench bench;
  const geometry::Pose there = in_the_box({0.2, 0.1, 0}, {0, 0.2, 0});
  EXPECT_FALSE(bench.find(TexturedBox(5).picture(there, 2)));
  EXPECT_FALSE(bench.find(TexturedBox(5, 0).picture(there, 2)));
  EXPECT_FALSE(bench.find(Image<Rgb8>(TexturedBox::kPicture)));
}

}  // namespace
}  // namespace mixrig::tracking

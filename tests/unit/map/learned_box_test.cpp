// SPDX-License-Identifier: Apache-2.0
// A patterned box learned from pictures of a moving fisheye, and the camera found in it again.
#include <gtest/gtest.h>

#include "extras/map/reconstruction/growth/reconstruct.h"
#include "extras/map/reconstruction/maps/map_finder.h"
#include "extras/map/reconstruction/maps/map_patches.h"
#include "host/math/estimation/points/rigid_fit.h"
#include "host/pose/tracker/tracker.h"
#include "tests/support/textured_box.h"

namespace mixrig {
namespace {

constexpr int kPictures = 14;

geometry::Pose place_of_picture(int i) {
  return test::in_the_box({-0.3 + 0.05 * i, 0.15 * std::sin(0.5 * i), 0.1 * std::cos(0.4 * i)},
                          {0.03 * std::sin(0.6 * i), 0.02 * i - 0.1, 0.02 * std::cos(0.3 * i)});
}

/// Learned once: it takes a second.
const Result<reconstruction::LearnedMap>& box_map() {
  static const auto map = [] {
    const test::TexturedBox box;
    reconstruction::TrackingOptions options;
    options.key_step_rad = 0.03, options.tracks = 300, options.features = 400;
    reconstruction::FeatureTracker tracker(test::TexturedBox::camera(), options);
    for (int i = 0; i < kPictures; ++i)
      tracker.add(box.picture(place_of_picture(i), 1, static_cast<unsigned>(i + 1)).view(),
                  0.1 * i);
    return reconstruction::reconstruct(tracker.finish(), test::TexturedBox::camera());
  }();
  return map;
}

/// The box from the map, by the path.
std::optional<estimation::Similarity> box_from_map() {
  if (!box_map()) return std::nullopt;
  std::vector<Eigen::Vector3d> found, truth;
  for (const auto& pose : box_map()->path) {
    found.push_back(pose.world_from_body.translation_m);
    truth.push_back(place_of_picture(static_cast<int>(std::lround(10 * pose.t_s))).translation_m);
  }
  const auto fit = estimation::similarity_fit(found, truth);
  return fit.usable() ? std::optional(fit.value) : std::nullopt;
}

TEST(LearnedBox, PathIsTheTrueOne) {
  ASSERT_TRUE(box_map()) << box_map().error().context;
  EXPECT_EQ(box_map()->path.size(), static_cast<std::size_t>(kPictures));
  const auto fit = box_from_map();
  ASSERT_TRUE(fit);
  double squares = 0;
  for (const auto& pose : box_map()->path) {
    const auto truth = place_of_picture(static_cast<int>(std::lround(10 * pose.t_s)));
    EXPECT_LT((*fit * pose.world_from_body.translation_m - truth.translation_m).norm(), 0.004);
    squares +=
        (*fit * pose.world_from_body.translation_m - truth.translation_m).squaredNorm() / kPictures;
  }
  RecordProperty("rms_um", static_cast<int>(1e6 * std::sqrt(squares)));
}

TEST(LearnedBox, PlacesLieOnTheWalls) {
  const auto fit = box_from_map();
  ASSERT_TRUE(fit);
  int near = 0;
  for (const auto& point : box_map()->points) {
    const Eigen::Vector3d p = *fit * point.place;
    double off = 1e9;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      off = std::min({off, std::abs(p[i] - test::TexturedBox::kLow_m[k]),
                      std::abs(p[i] - test::TexturedBox::kHigh_m[k])});
    }
    near += off < 0.1 ? 1 : 0;
  }
  EXPECT_GT(near, 0.9 * static_cast<double>(box_map()->points.size()));
}

/// The map in metres of the box, and a tracker in it.
struct BoxTracker {
  reconstruction::LearnedMap map;
  geometry::AnyCamera camera = test::TexturedBox::camera();
  Crew crew{1};
  tracking::Tracker tracker;

  explicit BoxTracker(double scale)
      : map([&] {
          auto scaled = *box_map();
          reconstruction::rescale(scaled, scale);
          return scaled;
        }()),
        tracker(
            reconstruction::patches_of(map, camera), camera, {},
            [&](const tracking::PatchMap& patches, const geometry::AnyCamera& own) {
              return std::make_unique<reconstruction::MapFinder>(map, patches, own,
                                                                 tracking::AlignOptions{});
            },
            crew) {}
};

TEST(LearnedBox, CameraIsFoundAndFollowedAndFoundAgainAfterBlackPictures) {
  const auto fit = box_from_map();
  ASSERT_TRUE(fit);
  BoxTracker t(fit->scale);
  const test::TexturedBox box;
  const Image<Rgb8> black(test::TexturedBox::kPicture);
  for (int i = 0; i < 8; ++i) {
    const bool covered = i == 3 || i == 4;
    // Poses between and beside those of the learned pictures.
    const geometry::Pose truth =
        test::in_the_box({-0.2 + 0.04 * i, 0.05, 0.12}, {0.04, 0.01 * i, -0.05});
    const auto pose = covered ? t.tracker.track(black.view(), 0.1 * i)
                              : t.tracker.track(box.picture(truth, 1, 70 + i).view(), 0.1 * i);
    ASSERT_EQ(pose.known, !covered) << i;
    if (!pose.known) continue;
    const Eigen::Vector3d found =
        fit->pose.rotation * pose.room_from_camera.translation_m + fit->pose.translation_m;
    EXPECT_LT((found - truth.translation_m).norm(), 0.01) << i;
    EXPECT_EQ(pose.searched, i == 0 || i == 5) << i;
  }
}

TEST(LearnedBox, ACameraInAnotherBoxIsNotFound) {
  const auto fit = box_from_map();
  ASSERT_TRUE(fit);
  BoxTracker t(fit->scale);
  const test::TexturedBox other(9);
  for (int i = 0; i < 4; ++i)
    EXPECT_FALSE(t.tracker.track(other.picture(place_of_picture(3 * i), 1).view(), 0.1 * i).known);
}

}  // namespace
}  // namespace mixrig

// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/tracker.h"

#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"
#include "tests/support/textured_box.h"

namespace mixrig::tracking {
namespace {

using test::in_the_box;
using test::TexturedBox;

constexpr double kRate_hz = 10;

/// A path of 0.3 m/s and 20 deg/s.
geometry::Pose on_the_path(int picture) {
  const double t = picture / kRate_hz;
  return in_the_box({0.3 * t - 0.3, 0.1 * t, 0.05 * t}, {0.05 * t, 0.02, 0.35 * t});
}

TrackerOptions narrow_options() {
  TrackerOptions options;
  options.start_radius_m = 0.5, options.start_radius_rad = 0.5;
  return options;
}

double sigma_mm(const TrackedPose& pose) {
  return 1e3 * std::sqrt(pose.covariance.diagonal().tail<3>().sum());
}

double error_mm(const TrackedPose& pose, const geometry::Pose& truth) {
  return 1e3 * (pose.room_from_camera.translation_m - truth.translation_m).norm();
}

TEST(Tracker, FollowsACameraWithoutDriftAndWithoutAllocation) {
  const TexturedBox box;
  Crew crew(2);
  Tracker tracker(box.panorama(), TexturedBox::camera(), narrow_options(), crew);
  for (int i = 0; i < 12; ++i) {
    const Image<Rgb8> picture = box.picture(on_the_path(i), 2, static_cast<unsigned>(i));
    const long before = test::allocations;
    const TrackedPose pose = tracker.track(picture, i / kRate_hz);
    if (i > 1) {
      EXPECT_EQ(test::allocations, before) << i;
    }
    ASSERT_TRUE(pose.known) << i;
    EXPECT_EQ(pose.searched, i == 0);
    EXPECT_LT(error_mm(pose, on_the_path(i)), 2) << i;
    EXPECT_LT(
        error_mm(pose, on_the_path(i)),
        5e3 * std::sqrt(pose.covariance(3, 3) + pose.covariance(4, 4) + pose.covariance(5, 5)));
  }
  EXPECT_EQ(tracker.counts().pictures, 12U);
  EXPECT_EQ(tracker.counts().lost, 0U);
  EXPECT_EQ(tracker.counts().searches, 1U);
}

TEST(Tracker, ARoomThatIsTooLargeIsInTheCovarianceWhereItsSigmaIsStated) {
  constexpr double kTooLarge = 0.01;
  const TexturedBox box;
  model::Panorama room = box.panorama();
  for (int y = 0; y < room.size().height; ++y)
    for (int x = 0; x < room.size().width; ++x)
      room.distance_m.row(y)[x] *= static_cast<float>(1 + kTooLarge);
  Crew crew(2);
  const geometry::Pose there = in_the_box({0.3, 0.4, -0.2}, {0, 0.1, 0.2});
  const auto nees = [&](double sigma) {
    TrackerOptions options = narrow_options();
    options.start_radius_m = 0.8;
    options.distance_sigma = sigma;
    Tracker tracker(room, TexturedBox::camera(), options, crew);
    const TrackedPose pose = tracker.track(box.picture(there, 2), 0);
    EXPECT_TRUE(pose.known);
    const Eigen::Vector3d off = pose.room_from_camera.translation_m - there.translation_m;
    EXPECT_LT((off - kTooLarge * there.translation_m).norm(), 0.001) << "by its way from the scan";
    return off.dot(pose.covariance.bottomRightCorner<3, 3>().ldlt().solve(off));
  };
  EXPECT_GT(nees(0), 20);
  EXPECT_LT(nees(kTooLarge), 3);
}

TEST(Tracker, PredictsByConstantVelocity) {
  const TexturedBox box;
  Crew crew(2);
  Tracker tracker(box.panorama(), TexturedBox::camera(), narrow_options(), crew);
  EXPECT_FALSE(tracker.predicted(0));
  for (int i = 0; i < 3; ++i) tracker.track(box.picture(on_the_path(i)), i / kRate_hz);
  const auto ahead = tracker.predicted(2.5 / kRate_hz);
  ASSERT_TRUE(ahead);
  const double t = 2.5 / kRate_hz;
  EXPECT_LT((ahead->translation_m - Eigen::Vector3d(0.3 * t - 0.3, 0.1 * t, 0.05 * t)).norm(),
            0.002);
}

TEST(Tracker, AfterForgettingItIsFoundAnyWhereInTheFirstField) {
  const TexturedBox box;
  Crew crew(2);
  Tracker tracker(box.panorama(), TexturedBox::camera(), narrow_options(), crew);
  for (int i = 0; i < 2; ++i) {
    const geometry::Pose there = in_the_box({i == 0 ? -0.3 : 0.3, 0.1, 0}, {0, 0.1, 0.2 - 0.3 * i});
    tracker.forget();
    const TrackedPose pose = tracker.track(box.picture(there, 2), 0.1 * i);
    ASSERT_TRUE(pose.known) << i;
    EXPECT_TRUE(pose.searched) << i;
    EXPECT_LT(error_mm(pose, there), 2) << i;
  }
}

TEST(Tracker, ACoveredLensIsLostAndFoundAgainWhereItIsThen) {
  const TexturedBox box;
  Crew crew(2);
  Tracker tracker(box.panorama(), TexturedBox::camera(), narrow_options(), crew);
  for (int i = 0; i < 3; ++i)
    ASSERT_TRUE(tracker.track(box.picture(on_the_path(i)), i / kRate_hz).known);
  const Image<Rgb8> covered(TexturedBox::kPicture);
  for (int i = 3; i < 6; ++i) EXPECT_FALSE(tracker.track(covered, i / kRate_hz).known);
  EXPECT_FALSE(tracker.predicted(0.6));
  EXPECT_EQ(tracker.counts().lost, 3U);
  const TrackedPose again = tracker.track(box.picture(on_the_path(6)), 6 / kRate_hz);
  ASSERT_TRUE(again.known);
  EXPECT_TRUE(again.searched);
  EXPECT_LT(error_mm(again, on_the_path(6)), 2);
}

TEST(Tracker, LightsThatGoOutAreLostOrRight) {
  const TexturedBox box, dark(1, 0.08);
  Crew crew(2);
  Tracker tracker(box.panorama(), TexturedBox::camera(), narrow_options(), crew);
  for (int i = 0; i < 6; ++i) {
    const auto& lit = i < 3 ? box : dark;
    const TrackedPose pose =
        tracker.track(lit.picture(on_the_path(i), 2, static_cast<unsigned>(i)), i / kRate_hz);
    if (i < 3) {
      ASSERT_TRUE(pose.known);
    }
    if (pose.known) {
      EXPECT_LT(error_mm(pose, on_the_path(i)), 4 * sigma_mm(pose)) << i << " " << sigma_mm(pose);
    }
  }
}

TEST(Tracker, BlurOfFastTurnsLeavesThePoseOfMidExposure) {
  const TexturedBox box;
  Crew crew(2);
  Tracker tracker(box.panorama(), TexturedBox::camera(), narrow_options(), crew);
  // Exposed for 4 degrees of a turn: 6 pixels in the middle of the picture.
  constexpr int kMoments = 9;
  const auto at = [](double t) { return in_the_box({0.2 * t, 0.1, 0}, {0.1 * t, 0, 0.35 * t}); };
  for (int i = 0; i < 5; ++i) {
    const double t = i / kRate_hz;
    Image<Rgb8> blurred(TexturedBox::kPicture);
    Image<float> sum(TexturedBox::kPicture);
    for (int k = 0; k < kMoments; ++k) {
      const Image<Rgb8> moment = box.picture(at(t + 0.2 * ((k + 0.5) / kMoments - 0.5)));
      for (int y = 0; y < sum.height(); ++y)
        for (int x = 0; x < sum.width(); ++x) sum.at(x, y) += moment.at(x, y).g / float{kMoments};
    }
    for (int y = 0; y < sum.height(); ++y)
      for (int x = 0; x < sum.width(); ++x) {
        const auto v = static_cast<std::uint8_t>(sum.at(x, y) + 0.5F);
        blurred.at(x, y) = {v, v, v};
      }
    const TrackedPose pose = tracker.track(blurred, t);
    ASSERT_TRUE(pose.known) << i;
    EXPECT_LT(error_mm(pose, at(t)), 4) << i;
  }
}

TEST(Tracker, AMirrorDoesNotPullThePose) {
  TexturedBox box;
  box.set({.mirror = true});
  Crew crew(2);
  Tracker tracker(box.panorama(), TexturedBox::camera(), narrow_options(), crew);
  for (int i = 0; i < 8; ++i) {
    const TrackedPose pose =
        tracker.track(box.picture(on_the_path(i), 2, static_cast<unsigned>(i)), i / kRate_hz);
    ASSERT_TRUE(pose.known) << i;
    EXPECT_LT(error_mm(pose, on_the_path(i)), 3) << i;
    EXPECT_LT(error_mm(pose, on_the_path(i)), 5 * sigma_mm(pose)) << i;
  }
}

TEST(Tracker, ADoorThatSwingsIsNotFollowed) {
  TexturedBox box;
  Crew crew(2);
  Tracker tracker(box.panorama(), TexturedBox::camera(), narrow_options(), crew);
  for (int i = 0; i < 10; ++i) {
    box.set({.door_rad = 0.12 * i});
    const TrackedPose pose =
        tracker.track(box.picture(on_the_path(i), 2, static_cast<unsigned>(i)), i / kRate_hz);
    ASSERT_TRUE(pose.known) << i;
    EXPECT_LT(error_mm(pose, on_the_path(i)), 3) << i;
    EXPECT_LT(error_mm(pose, on_the_path(i)), 5 * sigma_mm(pose)) << i;
  }
}

TEST(Tracker, ThousandsOfPicturesDoNotDrift) {
  const TexturedBox box;
  Crew crew(1);
  TrackerOptions options = narrow_options();
  options.align.patches = 40, options.align.finest = 1;
  Tracker tracker(box.panorama(), TexturedBox::camera(), options, crew);
  constexpr int kPictures = 8, kLoops = 130;
  std::vector<Image<Rgb8>> pictures;
  for (int i = 0; i < kPictures; ++i)
    pictures.push_back(box.picture(on_the_path(i), 2, static_cast<unsigned>(i)));
  double first = 0, last = 0;
  for (int n = 0; n < 2 * kLoops * kPictures; ++n) {  // to and fro
    const int turn = n % (2 * kPictures);
    const int i = turn < kPictures ? turn : 2 * kPictures - 1 - turn;
    const TrackedPose pose = tracker.track(pictures[static_cast<std::size_t>(i)], n / kRate_hz);
    ASSERT_TRUE(pose.known) << n;
    const double error = error_mm(pose, on_the_path(i));
    if (n >= 2 * kPictures && n < 4 * kPictures) first += error;
    if (n >= 2 * (kLoops - 1) * kPictures) last += error;
  }
  EXPECT_NEAR(last / first, 1, 0.02);
  EXPECT_LT(last / (2 * kPictures), 4);
}

TEST(Tracker, LooksFirstWhereTheScanLooked) {
  const TexturedBox box;
  model::Panorama room = box.panorama();
  EXPECT_TRUE(looking_at_the_scan(room).rotation.isApprox(looking_ahead().rotation));
  // Everything is unknown except a cap around one direction.
  const Eigen::Vector3d middle = Eigen::Vector3d(-0.5, -0.4, 0.6).normalized();
  for (int y = 0; y < room.size().height; ++y)
    for (int x = 0; x < room.size().width; ++x)
      if (model::direction_of(room.size(), x, y).dot(middle) < 0.8) room.distance_m.at(x, y) = 0;
  const geometry::Pose pose = looking_at_the_scan(room);
  EXPECT_GT((pose.rotation * Eigen::Vector3d::UnitZ()).dot(middle), 0.999);
  EXPECT_EQ(pose.translation_m, Eigen::Vector3d::Zero());
}

TEST(Tracker, AnotherRoomIsNeverTracked) {
  const TexturedBox box, other(9);
  Crew crew(2);
  Tracker tracker(box.panorama(), TexturedBox::camera(), narrow_options(), crew);
  for (int i = 0; i < 3; ++i)
    EXPECT_FALSE(tracker.track(other.picture(on_the_path(i), 2), i / kRate_hz).known);
  EXPECT_EQ(tracker.counts().lost, 3U);
}

}  // namespace
}  // namespace mixrig::tracking

// SPDX-License-Identifier: Apache-2.0
// Poses of the target camera of a rig whose fisheye sees a box that has a formula.
#include "host/pose/tracker/tracker_poses.h"

#include <gtest/gtest.h>

#include "tests/support/textured_box.h"

namespace mixrig::pose {
namespace {

using capture::CameraPose;
using capture::Capture;
using capture::PoseLoss;
using geometry::Pose;
using test::TexturedBox;

const Pose kWorldFromBase{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())),
                          {1, 2, 1.5}};
const Pose kTrackerFisheyeFromTarget{
    Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitX())), {0.07, -0.08, 0.01}};
constexpr double kPictureStep_s = 0.1;

Pose room_from_fisheye_at(double t_s) {
  return test::in_the_box({0.4 * t_s - 0.2, 0.1, 0.1 * t_s}, {0, 0.03, 0.3 * t_s});
}
Pose world_from_target_at(double t_s) {
  return kWorldFromBase * room_from_fisheye_at(t_s) * kTrackerFisheyeFromTarget;
}

HostTime at(double t_s) {
  return HostTime(Duration(static_cast<std::int64_t>(std::llround(t_s * 1e9))));
}

class TrackerPosesTest : public ::testing::Test {
 protected:
  TrackerPosesTest() { make(0); }
  void make(double smooth_s) {
    TrackerPoseOptions options;
    options.fisheye = TexturedBox::camera();
    options.fisheye_from_target = kTrackerFisheyeFromTarget,
    options.world_from_base = kWorldFromBase;
    options.tracker.start_radius_m = 0.4, options.tracker.start_radius_rad = 0.4;
    options.threads = 2, options.smooth_s = smooth_s;
    poses_ = make_tracker_poses(box_.panorama(), options);
  }

  /// A frame at `plate_s` whose fisheye was exposed at `picture_s`.
  static Capture capture_at(double plate_s, double picture_s, const Image<Rgb8>& picture) {
    Capture capture;
    capture.mid_exposure = at(plate_s), capture.time_s = plate_s;
    capture.fisheye = picture, capture.fisheye_mid_exposure = at(picture_s);
    capture.set_status(capture::Stream::kFisheye, capture::StreamStatus::kFresh);
    return capture;
  }
  CameraPose pose_at(double plate_s, double picture_s, const Image<Rgb8>& picture) {
    return poses_->pose_of(capture_at(plate_s, picture_s, picture));
  }
  CameraPose pose_at(double plate_s, double picture_s) {
    return pose_at(plate_s, picture_s, box_.picture(room_from_fisheye_at(picture_s), 2));
  }
  static double error_m(const CameraPose& pose, double t_s) {
    return (pose.world_from_target.translation_m - world_from_target_at(t_s).translation_m).norm();
  }

  TexturedBox box_;
  std::unique_ptr<capture::PoseSource> poses_;
};

TEST_F(TrackerPosesTest, ArePlacedAtThePlatesOwnTime) {
  for (int i = 0; i < 3; ++i) pose_at(i * kPictureStep_s, i * kPictureStep_s);
  // Times before the newest picture, at it, and after it.
  double sigma_m = 0;
  for (const double plate_s : {0.26, 0.3, 0.37}) {
    const CameraPose pose = pose_at(plate_s, 0.3);
    ASSERT_TRUE(pose.ok());
    EXPECT_LT(error_m(pose, plate_s), 0.003) << plate_s;
    EXPECT_LT(
        pose.world_from_target.rotation.angularDistance(world_from_target_at(plate_s).rotation),
        0.001);
    EXPECT_NEAR(pose.age_s, std::abs(plate_s - 0.3), 1e-9);
    ASSERT_TRUE(pose.covariance);
    sigma_m = std::sqrt(pose.covariance->diagonal().tail<3>().sum());
    if (plate_s < 0.35) {
      EXPECT_LT(sigma_m, 0.002);
    }
  }
  EXPECT_GT(sigma_m, 0.5 * 0.07 * 0.07);  // what a change of speed can do in 70 ms
  EXPECT_TRUE(poses_->info().moves);
  EXPECT_EQ(poses_->info().name, "tracker");
}

TEST_F(TrackerPosesTest, WithALatencyAPlateIsPlacedByThePicturesAfterIt) {
  EXPECT_EQ(poses_->info().latency_s, 0);
  make(0.2);
  EXPECT_EQ(poses_->info().latency_s, 0.2);
  std::vector<Capture> held;
  for (int i = 0; i < 6; ++i) {
    const double t_s = i * kPictureStep_s;
    held.push_back(capture_at(t_s + 0.03, t_s, box_.picture(room_from_fisheye_at(t_s), 2)));
    poses_->see(held.back());
    if (i < 3) continue;
    const double plate_s = t_s + 0.03 - 0.3;
    const CameraPose pose = poses_->pose_of(held[static_cast<std::size_t>(i - 3)]);
    ASSERT_TRUE(pose.ok());
    EXPECT_LT(error_m(pose, plate_s), 0.003) << plate_s;
    EXPECT_NEAR(pose.age_s, 0.03, 1e-9);
    ASSERT_TRUE(pose.covariance);
  }
}

TEST_F(TrackerPosesTest, SayWhyThereIsNone) {
  Capture without;
  EXPECT_EQ(poses_->pose_of(without).loss, PoseLoss::kAbsent);
  ASSERT_TRUE(pose_at(0, 0).ok());
  EXPECT_EQ(pose_at(0.1, 0.1, Image<Rgb8>(TexturedBox::kPicture)).loss, PoseLoss::kUntracked);
  EXPECT_TRUE(pose_at(0.2, 0.2).ok());
}

TEST_F(TrackerPosesTest, PicturesOfAnotherSizeAreLeftOut) {
  EXPECT_EQ(pose_at(0, 0, Image<Rgb8>({64, 48})).loss, PoseLoss::kAbsent);
  EXPECT_TRUE(pose_at(0.1, 0.1).ok());
  EXPECT_TRUE(pose_at(0.14, 0.2, Image<Rgb8>({64, 48})).ok());
}

TEST_F(TrackerPosesTest, AFisheyeThatGivesNoPictureIsLostAndSaid) {
  ASSERT_TRUE(pose_at(0, 0).ok());
  Capture without;
  without.mid_exposure = at(0.2), without.time_s = 0.2;
  without.set_status(capture::Stream::kFisheye, capture::StreamStatus::kMissing);
  EXPECT_EQ(poses_->pose_of(without).loss, PoseLoss::kNoPicture);
  EXPECT_TRUE(pose_at(0.3, 0.3).ok()) << "it is back";
}

TEST_F(TrackerPosesTest, OnePictureIsTrackedOnce) {
  ASSERT_TRUE(pose_at(0, 0).ok());
  // A covered picture with a stamp that was already processed is ignored.
  EXPECT_TRUE(pose_at(0.04, 0, Image<Rgb8>(TexturedBox::kPicture)).ok());
}

}  // namespace
}  // namespace mixrig::pose

// SPDX-License-Identifier: Apache-2.0
// Plates between the pictures of a fisheye on a head that pans to and fro: the chain of the truth
// is written with matrices in tests/support.
#include "host/pose/source/picture_motion.h"

#include <gtest/gtest.h>

#include "tests/support/axes_chain.h"

namespace mixrig::pose {
namespace {

using geometry::Pose;

const Pose kFisheyeFromTarget{Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX())),
                              {0.02, -0.09, 0.01}};
constexpr double kPlate_s = 0.04, kPicture_s = 0.1, kLag_s = 0.0137;
constexpr double kTurns_s = 0.8;  ///< of a plate: the pan turns back there

calibration_file::PanTilt unit() {
  calibration_file::PanTilt unit;
  unit.pan.direction = Eigen::Vector3d::UnitZ();
  unit.tilt.direction = Eigen::Vector3d::UnitX();
  unit.tilt.point_m = {0, 0.03, 0.1};
  unit.head_from_target = {Eigen::Quaterniond(Eigen::AngleAxisd(-1.6, Eigen::Vector3d::UnitX())),
                           {0.05, 0.1, 0.2}};
  return unit;
}

/// 0.5 rad/s, and back.
double pan_rad(double t_s) { return 0.5 * (t_s < kTurns_s ? t_s : 2 * kTurns_s - t_s); }

/// Pose of the camera when the carrier of the head moves at `speed_m_s`.
Pose room_from_target(double t_s, double speed_m_s) {
  const Eigen::Isometry3d chain = test::base_from_target(unit(), pan_rad(t_s), 0.1 * t_s);
  return {Eigen::Quaterniond(chain.rotation()),
          chain.translation() + Eigen::Vector3d(1 + speed_m_s * t_s, 0.2, 0.3)};
}

struct Worst {
  double mm = 0, deg = 0;
};

MeasuredPose measured(double at_s, const Pose& room_from_fisheye) {
  return {at_s, room_from_fisheye, 1e-8 * capture::PoseCovariance::Identity()};
}

/// Over the plates from 0.3 s on, as the pictures come; `angles_until`: then the head is silent.
Worst worst_of(Predict by, double speed_m_s, double angles_until_s = 1e9) {
  PictureMotion motion(by, kFisheyeFromTarget, unit());
  Worst worst;
  int pictures = 0;
  for (int plate = 0; plate < 40; ++plate) {
    const double t_s = plate * kPlate_s;
    if (t_s < angles_until_s) motion.add_angles(t_s, {pan_rad(t_s), 0.1 * t_s});
    for (double at_s = pictures * kPicture_s + kLag_s; at_s <= t_s;
         at_s = ++pictures * kPicture_s + kLag_s)
      motion.add_picture(
          measured(at_s, room_from_target(at_s, speed_m_s) * geometry::inverse(kFisheyeFromTarget)),
          false);
    const auto pose = motion.at(t_s);
    if (t_s < 0.3) continue;
    EXPECT_TRUE(pose) << t_s;
    if (!pose) continue;
    const Pose truth = room_from_target(t_s, speed_m_s);
    worst.mm = std::max(worst.mm, 1e3 * (pose->translation_m - truth.translation_m).norm());
    worst.deg = std::max(worst.deg, 57.3 * pose->rotation.angularDistance(truth.rotation));
  }
  return worst;
}

TEST(PictureMotion, ByTheHeadHoldsWhereThePanTurnsBack) {
  const Worst head = worst_of(Predict::kHead, 0);
  EXPECT_LT(head.mm, 1e-6);
  EXPECT_LT(head.deg, 1e-6);
  const Worst velocity = worst_of(Predict::kVelocity, 0);
  EXPECT_GT(velocity.deg, 3) << "it goes on for 0.1 s with the wrong sign of 0.5 rad/s";
}

TEST(PictureMotion, ByBothHoldsOnWhatMovesToo) {
  EXPECT_GT(worst_of(Predict::kHead, 0.3).mm, 15) << "0.3 m/s for up to 0.1 s";
  const Worst both = worst_of(Predict::kBoth, 0.3);
  EXPECT_LT(both.mm, 1e-6);
  EXPECT_LT(both.deg, 1e-6);
}

TEST(PictureMotion, WithoutAnglesTheVelocityGoesOn) {
  const Worst silent = worst_of(Predict::kHead, 0, 0), velocity = worst_of(Predict::kVelocity, 0);
  EXPECT_EQ(silent.mm, velocity.mm);
  EXPECT_EQ(silent.deg, velocity.deg);
  EXPECT_GT(worst_of(Predict::kHead, 0, 0.6).deg, 3) << "no angle is guessed";
}

TEST(PictureMotion, EndsWhereTheCameraIsLostAndDoesNotRunAway) {
  PictureMotion motion(Predict::kVelocity, {}, std::nullopt);
  EXPECT_FALSE(motion.at(0));
  motion.add_picture(measured(0, {}), true);
  motion.add_picture(measured(0.1, {Eigen::Quaterniond::Identity(), {0.1, 0, 0}}), false);
  EXPECT_NEAR(motion.at(0.2)->translation_m.x(), 0.2, 1e-12);
  EXPECT_NEAR(motion.at(0.05)->translation_m.x(), 0.05, 1e-12);
  EXPECT_NEAR(motion.at(5)->translation_m.x(), 0.1, 1e-12);
  motion.add_picture(measured(0.2, {Eigen::Quaterniond::Identity(), {7, 0, 0}}), true);
  EXPECT_NEAR(motion.at(0.25)->translation_m.x(), 7, 1e-12) << "found anew: no motion is known";
  motion.lose(0.3);
  EXPECT_FALSE(motion.at(0.3));
}

/// The worst of the plates between 0.3 s and 1.3 s of take, once all pictures are there.
Worst worst_smoothed(Predict by, double speed_m_s) {
  constexpr double kReach_s = 0.25;
  PictureMotion motion(by, kFisheyeFromTarget, unit());
  for (int plate = 0; plate < 40; ++plate)
    motion.add_angles(plate * kPlate_s, {pan_rad(plate * kPlate_s), 0.1 * plate * kPlate_s});
  for (int i = 0; i < 16; ++i) {
    const double at_s = i * kPicture_s + kLag_s;
    motion.add_picture(
        measured(at_s, room_from_target(at_s, speed_m_s) * geometry::inverse(kFisheyeFromTarget)),
        false);
  }
  Worst worst;
  for (int plate = 8; plate < 33; ++plate) {
    const double t_s = plate * kPlate_s;
    const auto place = motion.smoothed_at(t_s, kReach_s);
    EXPECT_TRUE(place) << t_s;
    if (!place) continue;
    const Pose truth = room_from_target(t_s, speed_m_s);
    worst.mm = std::max(worst.mm,
                        1e3 * (place->room_from_target.translation_m - truth.translation_m).norm());
    worst.deg = std::max(worst.deg,
                         57.3 * place->room_from_target.rotation.angularDistance(truth.rotation));
    EXPECT_LE(place->nearest_s, 0.5 * kPicture_s + 1e-9);
  }
  return worst;
}

TEST(PictureMotion, SmoothedFollowsAPanThatTurnsBackWithoutLag) {
  const Worst velocity = worst_smoothed(Predict::kVelocity, 0.3);
  EXPECT_LT(velocity.deg, 1) << "0.5 rad/s to -0.5 between two pictures";
  const Worst head = worst_smoothed(Predict::kHead, 0.3);
  EXPECT_LT(head.deg, 1e-3);
  EXPECT_LT(head.mm, 0.1) << "what carries the head moves steadily: no prediction is needed";
}

TEST(PictureMotion, SmoothedIsLostWhereTheNearestPictureIs) {
  PictureMotion motion(Predict::kVelocity, {}, std::nullopt);
  EXPECT_FALSE(motion.smoothed_at(0, 0.3));
  const auto at_x = [](double t_s, double x_m) {
    return measured(t_s, {Eigen::Quaterniond::Identity(), {x_m, 0, 0}});
  };
  for (int i = 0; i < 3; ++i) motion.add_picture(at_x(0.1 * i, 0.1 * i), i == 0);
  motion.lose(0.3);
  motion.add_picture(at_x(0.4, 7), true);
  motion.add_picture(at_x(0.5, 7), false);
  EXPECT_NEAR(motion.smoothed_at(0.15, 0.3)->room_from_target.translation_m.x(), 0.15, 1e-6);
  EXPECT_NEAR(motion.smoothed_at(0.24, 0.3)->room_from_target.translation_m.x(), 0.24, 1e-6);
  EXPECT_FALSE(motion.smoothed_at(0.3, 0.3));
  EXPECT_FALSE(motion.smoothed_at(0.34, 0.3));
  EXPECT_NEAR(motion.smoothed_at(0.36, 0.3)->room_from_target.translation_m.x(), 7, 1e-6)
      << "not mixed with those before it was lost";
  EXPECT_FALSE(motion.smoothed_at(1.2, 0.3));
}

}  // namespace
}  // namespace mixrig::pose

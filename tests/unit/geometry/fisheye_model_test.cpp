// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/fisheye_model.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

FisheyeModel lens() {
  return FisheyeModel({{960, 600}, 228, 227, 472, 305, {0.0218, -0.0143, 0.0128, -0.0017}});
}

/// An equidistant lens: theta_d = theta, for all directions but the backward one.
FisheyeModel equidistant() { return FisheyeModel({{1000, 1000}, 150, 150, 499.5, 499.5, {}}); }

Vector3d direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

TEST(FisheyeModel, MapsTheAngleInProportionWithoutCoefficients) {
  const auto px = equidistant().project(5.0 * direction(2.0, 0));  // 115 degrees off the axis
  ASSERT_TRUE(px);
  EXPECT_NEAR(px->x(), 499.5 + 300, 1e-10);
  EXPECT_NEAR(px->y(), 499.5, 1e-10);
}

TEST(FisheyeModel, MatchesOpenCvByHand) {
  // (1, 0.5, 1): theta = atan(1.1180), series and scale by hand.
  const double r = std::sqrt(1.25), t = std::atan(r);
  const double bent = t + 0.0218 * std::pow(t, 3) - 0.0143 * std::pow(t, 5) +
                      0.0128 * std::pow(t, 7) - 0.0017 * std::pow(t, 9);
  const auto px = lens().project({1, 0.5, 1});
  ASSERT_TRUE(px);
  EXPECT_NEAR(px->x(), 228 * bent / r + 472, 1e-10);
  EXPECT_NEAR(px->y(), 227 * 0.5 * bent / r + 305, 1e-10);
}

TEST(FisheyeModel, UnprojectsWhatItProjectsBeyondARightAngle) {
  for (const FisheyeModel& camera : {lens(), equidistant()})
    for (double theta = 0; theta < camera.domain_rad() - 1e-3; theta += 0.05)
      for (double phi = 0.1; phi < 6; phi += 1) {
        const Vector3d d = direction(theta, phi);
        const auto px = camera.project(3.0 * d);
        ASSERT_TRUE(px);
        const auto back = camera.unproject(*px);
        ASSERT_TRUE(back);
        EXPECT_LT((*back - d).norm(), 1e-9) << "theta " << theta;
      }
}

TEST(FisheyeModel, KnowsItsDomain) {
  EXPECT_NEAR(equidistant().domain_rad(), M_PI, 1e-12);
  // theta - theta^3 / 3 turns at theta = 1.
  const FisheyeModel folding({{640, 480}, 200, 200, 320, 240, {-1.0 / 3, 0, 0, 0}});
  EXPECT_NEAR(folding.domain_rad(), 1.0, 1e-9);
  EXPECT_FALSE(folding.project(direction(1.1, 0)));
  EXPECT_FALSE(folding.unproject({320 + 200 * 0.67, 240}));
  EXPECT_FALSE(lens().project({0, 0, 0}));
  EXPECT_FALSE(lens().project({0, 0, -1}));
  EXPECT_FALSE(lens().unproject({NAN, 0}));
  EXPECT_FALSE(validate(folding));
  EXPECT_TRUE(validate(lens()));
}

/// A lens of 200 degrees whose image is a circle of radius `150 * 100 degrees` inside the picture.
FisheyeModel circular() {
  FisheyeModel::Parameters p = equidistant().parameters();
  p.max_angle_rad = 100 * M_PI / 180;
  return FisheyeModel(p);
}

TEST(FisheyeModel, EndsAtItsLargestAngle) {
  const FisheyeModel camera = circular();
  const double largest = *camera.parameters().max_angle_rad;
  EXPECT_EQ(camera.domain_rad(), largest);
  EXPECT_NEAR(camera.fold_rad(), M_PI, 1e-12);
  EXPECT_NEAR(camera.rim_px().x(), 150 * largest, 1e-9);
  for (double phi = 0; phi < 6; phi += 0.7) {
    EXPECT_TRUE(camera.project(direction(largest - 1e-9, phi)));
    EXPECT_FALSE(camera.project(direction(largest + 1e-9, phi)));
    const Vector2d out(std::cos(phi), std::sin(phi)), middle(499.5, 499.5);
    const auto ray = camera.unproject(middle + (150 * largest - 1e-6) * out);
    ASSERT_TRUE(ray);
    EXPECT_LT((*ray - direction(largest, phi)).norm(), 1e-7);
    EXPECT_FALSE(camera.unproject(middle + (150 * largest + 1e-6) * out));
  }
  EXPECT_FALSE(camera.unproject({0, 0}));  // a corner is no picture
}

TEST(FisheyeModel, LargestAngleChangesNothingInsideIt) {
  for (double theta = 0; theta < 1.7; theta += 0.1) {
    const Vector3d d = direction(theta, 1);
    EXPECT_EQ(*circular().project(d), *equidistant().project(d));
    EXPECT_EQ(circular().jacobian(d), equidistant().jacobian(d));
  }
}

TEST(FisheyeModel, JacobianMatchesDifferences) {
  const FisheyeModel camera = lens();
  for (const Vector3d& p :
       {Vector3d(0.3, -0.2, 1), Vector3d(1e-13, 0, 2), Vector3d(2, 1, -0.3), Vector3d(0, 1, 0)}) {
    const auto j = camera.jacobian(p);
    for (int k = 0; k < 3; ++k) {
      Vector3d step = Vector3d::Zero();
      step[k] = 1e-6;
      const Vector2d slope = (*camera.project(p + step) - *camera.project(p - step)) / 2e-6;
      EXPECT_LT((j.col(k) - slope).norm(), 1e-5 * (1 + slope.norm())) << p.transpose();
    }
  }
}

TEST(ValidateFisheye, AFoldCountsWhereThereIsImage) {
  // theta - theta^3 / 10 turns at 1.826 rad, 104.6 degrees, 182 px from the centre.
  FisheyeModel::Parameters p{{1000, 1000}, 150, 150, 499.5, 499.5, {-0.1, 0, 0, 0}};
  const auto refusal = [&] {
    const auto valid = validate(FisheyeModel(p));
    return valid ? std::string() : valid.error().context;
  };
  EXPECT_NE(refusal().find("folds inside the picture, 104.6 degrees"), std::string::npos);
  p.max_angle_rad = 1.8;  // the circle ends before the fold
  EXPECT_EQ(refusal(), "");
  p.max_angle_rad = 1.85;
  EXPECT_NE(refusal().find("folds inside its image, 104.6 degrees"), std::string::npos);
  EXPECT_NE(refusal().find("largest angle is 106.0 degrees"), std::string::npos) << refusal();
  p.size_px = {250, 250};  // its corners lie 176 px away: the fold is beyond them
  p.cx_px = p.cy_px = 124.5;
  EXPECT_EQ(refusal(), "");
}

TEST(ValidateFisheye, RefusesBrokenValues) {
  FisheyeModel::Parameters p = lens().parameters();
  p.fx_px = 0;
  EXPECT_FALSE(validate(FisheyeModel(p)));
  p = lens().parameters();
  p.k[2] = NAN;
  EXPECT_FALSE(validate(FisheyeModel(p)));
  p = lens().parameters();
  p.size_px = {0, 480};
  EXPECT_FALSE(validate(FisheyeModel(p)));
  for (const double angle : {0.0, -1.0, 3.15, static_cast<double>(NAN), 1e300}) {
    p = equidistant().parameters();
    p.max_angle_rad = angle;
    EXPECT_FALSE(validate(FisheyeModel(p))) << angle;
  }
}

}  // namespace
}  // namespace mixrig::geometry

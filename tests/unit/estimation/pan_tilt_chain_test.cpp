// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/pan_tilt_chain.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/random_geometry.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr double kDegree = M_PI / 180;
constexpr double kChainSigma_rad = 2e-4, kChainSigma_m = 2e-4;

/// Axes 0.4 deg off square, 3 mm apart; encoders that read 0.2 % and 0.5 % short.
PanTiltCalibration unit() {
  PanTiltCalibration truth;
  truth.chain = {
      0.4 * kDegree, 0.003, 1.002, 1.005, {rotation_exp({-1.5, 0.1, 0.05}), {0.04, 0.11, 0.07}}};
  truth.base_from_target = {rotation_exp({1.6, 0.2, -0.1}), {0.3, 1.6, 0.2}};
  return truth;
}

struct Tour {
  double pan_rad = 40 * kDegree, tilt_rad = 25 * kDegree;
  double angle_sigma_rad = 0;
  std::uint64_t seed = 1;
};

/// 5 x 4 positions of the unit, each view with the same noise.
std::vector<PanTiltView> views_of(const PanTiltCalibration& truth, const Tour& tour) {
  test::RandomGeometry random(tour.seed);
  std::vector<PanTiltView> views;
  for (int p = -2; p <= 2; ++p)
    for (int t = 0; t < 4; ++t) {
      PanTiltView view;
      view.pan_rad = tour.pan_rad * p / 2;
      view.tilt_rad = tour.tilt_rad * (t - 1.5) / 1.5;
      const Pose camera = base_from_camera(
          truth.chain,
          view.pan_rad + tour.angle_sigma_rad * random.normal() / truth.chain.pan_scale,
          view.tilt_rad + tour.angle_sigma_rad * random.normal() / truth.chain.tilt_scale);
      view.camera_from_target = geometry::inverse(camera) * truth.base_from_target;
      view.camera_from_target.rotation =
          rotation_exp(random.normal3(kChainSigma_rad)) * view.camera_from_target.rotation;
      view.camera_from_target.translation_m += random.normal3(kChainSigma_m);
      view.covariance.diagonal() << Vector3d::Constant(kChainSigma_rad * kChainSigma_rad),
          Vector3d::Constant(kChainSigma_m * kChainSigma_m);
      views.push_back(view);
    }
  return views;
}

Eigen::Matrix<double, 16, 1> error_of(const PanTiltCalibration& fit,
                                      const PanTiltCalibration& truth) {
  Eigen::Matrix<double, 16, 1> error;
  error << fit.chain.skew_rad - truth.chain.skew_rad, fit.chain.offset_m - truth.chain.offset_m,
      fit.chain.pan_scale - truth.chain.pan_scale, fit.chain.tilt_scale - truth.chain.tilt_scale,
      pose_error(fit.chain.head_from_camera, truth.chain.head_from_camera),
      pose_error(fit.base_from_target, truth.base_from_target);
  return error;
}

TEST(PanTiltChain, TurnsAsItsWordsSay) {
  PanTiltChain chain;
  chain.offset_m = 0.1;
  chain.pan_scale = 2;
  // Pan by a true 90 degrees about z takes the tilt axis from y = 0.1 to x = -0.1 and along y.
  const Pose panned = base_from_head(chain, 45 * kDegree, 0);
  EXPECT_LT((panned * Vector3d(0, 0, 0) - Vector3d(-0.1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((panned * Vector3d(1, 0, 0) - Vector3d(-0.1, 1, 0)).norm(), 1e-12);
  // Tilt leaves its own axis alone and lifts y to z.
  const Pose tilted = base_from_head(chain, 0, 90 * kDegree);
  EXPECT_LT((tilted * Vector3d(1, 0, 0) - Vector3d(1, 0.1, 0)).norm(), 1e-12);
  EXPECT_LT((tilted * Vector3d(0, 1, 0) - Vector3d(0, 0.1, 1)).norm(), 1e-12);
}

TEST(PanTiltChain, FindsAxesScalesAndCentreWithTheSigmaThatItClaims) {
  const PanTiltCalibration truth = unit();
  for (const double angle_sigma_rad : {0.0, 3e-4}) {
    double nees = 0;
    constexpr int kTrials = 30;
    for (int trial = 0; trial < kTrials; ++trial) {
      Tour tour;
      tour.angle_sigma_rad = angle_sigma_rad;
      tour.seed = 100 + trial;
      const auto fit = calibrate_pan_tilt(views_of(truth, tour), angle_sigma_rad);
      ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
      const auto error = error_of(fit.value, truth);
      nees += error.dot(fit.covariance.ldlt().solve(error)) / 16;
      EXPECT_LT(error.segment<3>(7).norm(), 6e-4) << "tool centre point";
      for (int k = 0; k < 16; ++k)
        EXPECT_LT(std::abs(error[k]), 5 * std::sqrt(fit.covariance(k, k))) << "parameter " << k;
    }
    // 480 degrees of freedom: 0.87..1.14 holds 95 %.
    EXPECT_GT(nees / kTrials, 0.83);
    EXPECT_LT(nees / kTrials, 1.18);
  }
}

TEST(PanTiltChain, LeavesOutAViewThatIsWrong) {
  const PanTiltCalibration truth = unit();
  auto views = views_of(truth, {});
  views[7].camera_from_target.translation_m.x() += 0.02;
  const auto fit = calibrate_pan_tilt(views);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_EQ(fit.inliers.size(), views.size() - 1);
  EXPECT_GT(fit.residuals[7], 10);
  EXPECT_LT(error_of(fit.value, truth).segment<3>(7).norm(), 6e-4);
}

TEST(PanTiltChain, RefusesWhatCannotCarryIt) {
  const PanTiltCalibration truth = unit();
  const auto refuses = [](const std::vector<PanTiltView>& views, double repeatability = 0) {
    const auto fit = calibrate_pan_tilt(views, repeatability);
    return !fit.usable() && !fit.verdict.reason.empty();
  };
  Tour no_pan, no_tilt;
  no_pan.pan_rad = 0;
  no_tilt.tilt_rad = 0;
  EXPECT_TRUE(refuses(views_of(truth, no_pan)));
  EXPECT_TRUE(refuses(views_of(truth, no_tilt)));
  auto views = views_of(truth, {});
  EXPECT_TRUE(refuses({views[0], views[7], views[19]}));
  EXPECT_TRUE(refuses(views, -1));
  EXPECT_TRUE(refuses({}));
  auto swapped = views;
  for (PanTiltView& v : swapped) std::swap(v.pan_rad, v.tilt_rad);
  EXPECT_TRUE(refuses(swapped));
  auto broken = views;
  broken[3].camera_from_target.translation_m.y() = NAN;
  EXPECT_TRUE(refuses(broken));
  broken = views;
  broken[3].covariance.setZero();
  EXPECT_TRUE(refuses(broken));
}

}  // namespace
}  // namespace mixrig::estimation

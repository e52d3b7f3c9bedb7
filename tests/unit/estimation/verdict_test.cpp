// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/verdict.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace mixrig::estimation {
namespace {

TEST(Judge, IsOkWhenAllDirectionsAreAlike) {
  const auto judged = judge(Eigen::Matrix3d::Identity() * 1e4, Eigen::Vector3d::Ones());
  EXPECT_EQ(judged.verdict.standing, Standing::kOk);
  EXPECT_NEAR(judged.covariance(1, 1), 1e-4, 1e-16);
}

TEST(Judge, NamesTheWeakDirectionAndItsSigma) {
  const Eigen::Matrix3d information = Eigen::Vector3d(1e4, 1e4, 100).asDiagonal();
  const auto judged = judge(information, Eigen::Vector3d::Ones());
  ASSERT_EQ(judged.verdict.standing, Standing::kWeak);
  EXPECT_NEAR(std::abs(judged.verdict.direction.z()), 1.0, 1e-12);
  EXPECT_NEAR(judged.verdict.sigma, 0.1, 1e-12);
}

TEST(Judge, RefusesSingularVagueAndBrokenInformation) {
  const auto standing = [](double a, double b) {
    return judge(Eigen::Vector2d(a, b).asDiagonal().toDenseMatrix(), Eigen::Vector2d::Ones())
        .verdict.standing;
  };
  EXPECT_EQ(standing(1e4, 0), Standing::kDegenerate);
  EXPECT_EQ(standing(1e4, 2), Standing::kDegenerate);  // sigma 0.7 of a scene of size 1
  EXPECT_EQ(standing(1e4, std::numeric_limits<double>::quiet_NaN()), Standing::kDegenerate);
}

TEST(Judge, ComparesParametersByTheirExtent) {
  // 0.01 rad of 1 rad and 10 m of 1000 m are equally well known.
  const Eigen::Matrix2d information = Eigen::Vector2d(1e4, 1e-2).asDiagonal();
  EXPECT_EQ(judge(information, Eigen::Vector2d(1, 1000)).verdict.standing, Standing::kOk);
}

TEST(Chi2Limit, MatchesTables) {
  // Upper tail at z = 3 (p = 0.00135): 10.273 (dof 1), 13.218 (2), 15.630 (3), 32.78 (12).
  EXPECT_NEAR(chi2_limit(1, 3) / 10.273, 1.0, 0.03);
  EXPECT_NEAR(chi2_limit(2, 3) / 13.218, 1.0, 0.02);
  EXPECT_NEAR(chi2_limit(3, 3) / 15.630, 1.0, 0.02);
}

TEST(RotationLog, InvertsExpUpToAHalfTurn) {
  for (const Eigen::Vector3d& w :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e-14, 0, 0), Eigen::Vector3d(0.3, -0.2, 0.9),
        Eigen::Vector3d(0, M_PI - 1e-9, 0)})
    EXPECT_LT((rotation_log(rotation_exp(w)) - w).norm(), 1e-12);
}

TEST(NoiseSigma, NeedsRedundancyOrAStatement) {
  EXPECT_FALSE(noise_sigma({}, 1.0, 0, 0));
  EXPECT_FALSE(noise_sigma(-1.0, 1.0, 5, 0));
  EXPECT_NEAR(*noise_sigma({}, 8.0, 2, 0), 2.0, 1e-15);
  EXPECT_EQ(*noise_sigma(0.5, 8.0, 2, 0), 0.5);
}

}  // namespace
}  // namespace mixrig::estimation

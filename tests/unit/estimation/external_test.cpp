// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/external.h"

#include <gtest/gtest.h>

#include "tests/support/random_geometry.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr double kExternalSigma_rad = 5e-4, kExternalSigma_m = 5e-3;

/// Six markers about 1.5 m before a camera, as in Cortes Reina 2015, figure 28.
std::vector<RangedSight> sights_of(const Pose& world_from_camera, std::uint64_t seed,
                                   double noise = 1) {
  test::RandomGeometry random(seed);
  std::vector<RangedSight> sights;
  for (int i = 0; i < 6; ++i) {
    const Vector3d seen(random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4),
                        random.uniform(1.2, 1.9));
    const Vector3d ray = seen.normalized() + random.normal3(noise * kExternalSigma_rad);
    sights.push_back({world_from_camera * seen, bearing_of(ray, kExternalSigma_rad),
                      seen.norm() + noise * kExternalSigma_m * random.normal()});
  }
  return sights;
}

TEST(LocateCamera, IsExactWithoutNoise) {
  const Pose truth{rotation_exp({0.3, 2.4, -0.5}), {3, -2, 1.5}};
  const auto fit = locate_camera(sights_of(truth, 1, 0), kExternalSigma_m);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_LT(pose_error(fit.value, truth).norm(), 1e-9);
}

TEST(LocateCamera, HasTheSigmaThatItClaimsInTheBodyToo) {
  const Pose world_from_body{rotation_exp({-0.2, 0.9, 0.4}), {2.9, -2.1, 1.4}};
  const Pose camera_on_body{rotation_exp({0.1, 1.5, -0.3}), {0.05, -0.03, 0.12}};
  double nees_camera = 0, nees_body = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Pose truth = world_from_body * camera_on_body;
    const auto camera = locate_camera(sights_of(truth, 10 + trial), kExternalSigma_m);
    ASSERT_TRUE(camera.usable()) << camera.verdict.reason;
    auto error = pose_error(camera.value, truth);
    nees_camera += error.dot(camera.covariance.inverse() * error) / 6;
    // A body with errors of its own.
    test::RandomGeometry random(5000 + trial);
    Estimate<Pose> body;
    body.verdict = Verdict::ok();
    body.covariance = Eigen::MatrixXd::Zero(6, 6);
    body.covariance.diagonal() << Vector3d::Constant(4e-6), Vector3d::Constant(1e-6);
    body.value = {rotation_exp(random.normal3(2e-3)) * world_from_body.rotation,
                  world_from_body.translation_m + random.normal3(1e-3)};
    const auto on_body = body_from_camera(body, camera);
    ASSERT_TRUE(on_body.usable());
    error = pose_error(on_body.value, camera_on_body);
    nees_body += error.dot(on_body.covariance.inverse() * error) / 6;
  }
  // 1200 degrees of freedom: 0.92..1.08 holds 95 %.
  EXPECT_NEAR(nees_camera / kTrials, 1, 0.12);
  EXPECT_NEAR(nees_body / kTrials, 1, 0.12);
}

TEST(LocateCamera, LeavesAWrongDistanceOut) {
  const Pose truth{rotation_exp({0.3, 2.4, -0.5}), {3, -2, 1.5}};
  auto sights = sights_of(truth, 3);
  sights[2].range_m += 0.3;
  const auto fit = locate_camera(sights, kExternalSigma_m);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_EQ(fit.inliers, (std::vector<int>{0, 1, 3, 4, 5}));
  EXPECT_LT(pose_error(fit.value, truth).tail<3>().norm(), 0.02);
}

TEST(LocateCamera, RefusesWhatCannotCarryIt) {
  const Pose truth{rotation_exp({0.3, 2.4, -0.5}), {3, -2, 1.5}};
  const auto refuses = [](const std::vector<RangedSight>& sights,
                          double sigma_m = kExternalSigma_m) {
    const auto fit = locate_camera(sights, sigma_m);
    return !fit.usable() && !fit.verdict.reason.empty();
  };
  const auto sights = sights_of(truth, 3);
  EXPECT_TRUE(refuses({sights[0], sights[1]}));
  EXPECT_TRUE(refuses({}));
  EXPECT_TRUE(refuses(sights, 0));
  EXPECT_TRUE(refuses(sights, NAN));
  auto line = sights;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Vector3d seen(0.1 * static_cast<double>(i), 0.2, 1.5);
    line[i] = {truth * seen, bearing_of(seen, kExternalSigma_rad), seen.norm()};
  }
  EXPECT_TRUE(refuses(line));
  auto mixed = sights;
  for (std::size_t i = 0; i < mixed.size(); ++i)
    mixed[i].world_m =
        sights[(i * 5 + 2) % 6].world_m + Vector3d(0.1 * static_cast<double>(i), 0, 0);
  EXPECT_TRUE(refuses(mixed));
  auto broken = sights;
  broken[1].range_m = -1;
  EXPECT_TRUE(refuses(broken));
  broken[1] = sights[1], broken[1].world_m.z() = NAN;
  EXPECT_TRUE(refuses(broken));
  EXPECT_FALSE(body_from_camera(Estimate<Pose>::degenerate("why"), {}).usable());
}

}  // namespace
}  // namespace mixrig::estimation

// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/any_camera.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

AnyCamera rational() {
  Eigen::VectorXd v(12);
  v << 1100, 1090, 640, 500, -0.28, 0.12, 1e-3, -2e-3, 0.03, 0.05, -0.02, 0.01;
  return make_camera(LensKind::kPinhole, {1280, 1024}, v);
}
AnyCamera wide() {
  Eigen::VectorXd v(8);
  v << 228, 227, 472, 305, 0.0218, -0.0143, 0.0128, -0.0017;
  return make_camera(LensKind::kFisheye, {960, 600}, v);
}

/// Points before both, on the axis, off it, and for the fisheye behind the image plane.
std::vector<Vector3d> points_for(const AnyCamera& camera) {
  std::vector<Vector3d> points{{0, 0, 2}, {0.3, -0.2, 1}, {-0.4, 0.3, 0.8}, {1e-12, 0, 1}};
  if (kind_of(camera) == LensKind::kFisheye) {
    points.push_back({2, 1, -0.3});
    points.push_back({0, 1, 0});
  }
  return points;
}

TEST(AnyCamera, ProjectsLikeTheModelItself) {
  for (const AnyCamera& camera : {rational(), wide()})
    for (const Vector3d& p : points_for(camera)) {
      const auto plain = project(camera, p);
      const auto with = project_with_jacobians(kind_of(camera), parameters_of(camera).data(), p);
      ASSERT_TRUE(plain && with);
      EXPECT_LT((*plain - with->px).norm(), 1e-9) << p.transpose();
      const auto ray = unproject(camera, *plain);
      ASSERT_TRUE(ray);
      EXPECT_LT((*ray - p.normalized()).norm(), 1e-9) << p.transpose();
    }
}

TEST(AnyCamera, JacobiansMatchDifferences) {
  for (const AnyCamera& camera : {rational(), wide()}) {
    const auto kind = kind_of(camera);
    const Eigen::VectorXd v = parameters_of(camera);
    const auto px = [&](const Eigen::VectorXd& values, const Vector3d& p) {
      return project_with_jacobians(kind, values.data(), p)->px;
    };
    for (const Vector3d& p : points_for(camera)) {
      const auto at = *project_with_jacobians(kind, v.data(), p);
      ASSERT_EQ(at.d_parameters.cols(), v.size());
      for (int k = 0; k < 3; ++k) {
        const Vector3d step = 1e-6 * Vector3d::Unit(k);
        const Vector2d slope = (px(v, p + step) - px(v, p - step)) / 2e-6;
        EXPECT_LT((at.d_point.col(k) - slope).norm(), 1e-5 * (1 + slope.norm())) << p.transpose();
      }
      for (int k = 0; k < v.size(); ++k) {
        const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(v.size(), k);
        const Vector2d slope = (px(v + step, p) - px(v - step, p)) / 2e-5;
        EXPECT_LT((at.d_parameters.col(k) - slope).norm(), 1e-5 * (1 + slope.norm()))
            << "parameter " << k << " at " << p.transpose();
      }
    }
  }
}

TEST(AnyCamera, RefusesPointsWithoutAPixel) {
  const Eigen::VectorXd pinhole = parameters_of(rational()), fisheye = parameters_of(wide());
  EXPECT_FALSE(project_with_jacobians(LensKind::kPinhole, pinhole.data(), {0, 0, 0}));
  EXPECT_FALSE(project_with_jacobians(LensKind::kPinhole, pinhole.data(), {0, 0, -1}));
  EXPECT_FALSE(project_with_jacobians(LensKind::kPinhole, pinhole.data(), {NAN, 0, 1}));
  EXPECT_FALSE(project_with_jacobians(LensKind::kFisheye, fisheye.data(), {0, 0, -1}));
  EXPECT_FALSE(project_with_jacobians(LensKind::kFisheye, fisheye.data(), {0, 0, 0}));
}

TEST(AnyCamera, NamesAsManyParametersAsItHas) {
  for (const AnyCamera& camera : {rational(), wide()}) {
    EXPECT_EQ(static_cast<int>(parameter_names(kind_of(camera)).size()),
              parameter_count(kind_of(camera)));
    EXPECT_EQ(parameters_of(make_camera(kind_of(camera), size_px(camera), parameters_of(camera))),
              parameters_of(camera));
    EXPECT_TRUE(validate(camera));
  }
}

}  // namespace
}  // namespace mixrig::geometry

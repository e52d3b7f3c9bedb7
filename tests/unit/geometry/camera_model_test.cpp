// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/camera_model.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace mixrig::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

CameraModel azure_kinect_depth() {  // published factory values of a real camera
  CameraModel c;
  c.pinhole = {{640, 576}, 504.6076, 504.7325, 332.7811, 348.8297};
  c.lens = Lens({0.5479397773742676, -0.020971370860934258, 2.0557534298859537e-05,
                 -7.210415787994862e-05, -0.002652231603860855, 0.8896790742874146,
                 0.08613020926713943, -0.013910384848713875});
  return c;
}

CameraModel barrel() {
  CameraModel c;
  c.pinhole = {{1280, 1024}, 1100, 1100, 639.5, 511.5};
  c.lens = Lens({-0.12, 0.02, 0.0005, -0.0003, 0, 0, 0, 0});
  return c;
}

TEST(CameraModel, PixelZeroIsTheCentreOfTheTopLeftPixel) {
  const Pinhole p{{100, 50}, 80, 90, 49.5, 24.5};
  EXPECT_TRUE(p.project({0, 0, 2}).isApprox(Vector2d(49.5, 24.5)));
  EXPECT_TRUE(p.project({1, -1, 2}).isApprox(Vector2d(89.5, -20.5)));
  EXPECT_TRUE(p.unproject({89.5, -20.5}).isApprox(Vector2d(0.5, -0.5)));
}

TEST(CameraModel, DistortsAsTheFormulaWorkedByHand) {
  CameraModel c = barrel();
  // x=0.3 y=-0.2: r2=0.13, gain=1-0.12*0.13+0.02*0.0169=0.984738
  const auto d = c.lens.distort({0.3, -0.2});
  ASSERT_TRUE(d);
  EXPECT_NEAR(d->x(), 0.3 * 0.984738 + 2 * 0.0005 * -0.06 + -0.0003 * (0.13 + 0.18), 1e-12);
  EXPECT_NEAR(d->y(), -0.2 * 0.984738 + 0.0005 * (0.13 + 0.08) + 2 * -0.0003 * -0.06, 1e-12);
}

TEST(CameraModel, UndistortInvertsDistortOverTheWholePicture) {
  for (const CameraModel& c : {azure_kinect_depth(), barrel()}) {
    for (int y = 0; y < c.size_px().height; y += 17)
      for (int x = 0; x < c.size_px().width; x += 13) {
        const auto ray = c.unproject({x, y});
        ASSERT_TRUE(ray) << x << "," << y;
        const auto back = c.project({ray->x() * 3, ray->y() * 3, 3.0});
        ASSERT_TRUE(back);
        EXPECT_LT((*back - Vector2d(x, y)).norm(), 1e-8);
      }
  }
}

TEST(CameraModel, JacobianIsTheNumericalOne) {
  const CameraModel c = azure_kinect_depth();
  const double h = 1e-6;
  for (const Vector2d& p : {Vector2d(0.1, 0.2), Vector2d(-0.5, 0.3), Vector2d(0, 0)}) {
    Eigen::Matrix2d numeric;
    for (int k = 0; k < 2; ++k) {
      Vector2d step = Vector2d::Zero();
      step[k] = h;
      numeric.col(k) = (*c.lens.distort(p + step) - *c.lens.distort(p - step)) / (2 * h);
    }
    EXPECT_LT((numeric - c.lens.jacobian(p)).norm(), 1e-8);
  }
}

TEST(CameraModel, KnowsWhereTheLensEnds) {
  Lens strong({-0.5, 0, 0, 0, 0, 0, 0, 0});  // r(1 - r2/2) turns at r2 = 2/3
  EXPECT_NEAR(strong.domain_r2(), 2.0 / 3.0, 1e-9);
  EXPECT_TRUE(strong.distort({0.8, 0.0}));
  EXPECT_FALSE(strong.distort({0.9, 0.0}));
  EXPECT_FALSE(strong.undistort({0.6, 0.0}));  // the largest image radius is sqrt(2/3) 2/3 = 0.544
}

TEST(CameraModel, PointsBehindTheCameraHaveNoPixel) {
  EXPECT_FALSE(barrel().project({0, 0, -1}));
  EXPECT_FALSE(barrel().project({0, 0, 0}));
  EXPECT_FALSE(barrel().project({0, 0, std::numeric_limits<double>::quiet_NaN()}));
}

TEST(CameraModel, ValidateNamesWhatIsWrong) {
  EXPECT_TRUE(validate(barrel()));
  CameraModel c = barrel();
  c.pinhole.fx_px = 0;
  EXPECT_FALSE(validate(c));
  c = barrel();
  c.pinhole.cx_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(validate(c));
  c = barrel();
  c.lens = Lens({-2.0, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_FALSE(validate(c));
  EXPECT_NE(validate(c).error().context.find("folds"), std::string::npos);
}

TEST(CameraModel, IdealViewOfABarrelLensKeepsTheFocalLength) {
  const Pinhole v = ideal_view(barrel());
  EXPECT_EQ(v.size_px, barrel().size_px());
  EXPECT_NEAR(v.fx_px, 1100, 1e-9);
}

TEST(CameraModel, IdealViewOfAPincushionLensZoomsUntilTheBorderIsCovered) {
  CameraModel c = barrel();
  c.lens = Lens({0.2, 0, 0, 0, 0, 0, 0, 0});
  const Pinhole v = ideal_view(c);
  EXPECT_GT(v.fx_px, 1100);
  const Vector2d ray = v.unproject({0, 0});
  const auto px = c.project({ray.x(), ray.y(), 1});
  ASSERT_TRUE(px);
  EXPECT_GE(px->x(), 0);
  EXPECT_GE(px->y(), 0);
  EXPECT_LT(std::min(px->x(), px->y()), 40);  // no more zoom than needed
}

}  // namespace
}  // namespace mixrig::geometry

// SPDX-License-Identifier: Apache-2.0
// The certainty of a rig against closed forms.
#include "host/calibrate/rig/rig_certainty.h"

#include <gtest/gtest.h>

namespace mixrig::calibration {
namespace {

RigModel two_cameras(double distance_m) {
  RigModel model;
  for (const double f_px : {600.0, 200.0}) {
    RigCamera& camera = model.cameras.emplace_back();
    camera.name = f_px > 400 ? "target" : "tof";
    camera.size_px = f_px > 400 ? Size{640, 480} : Size{160, 120};
    camera.parameters = Eigen::VectorXd::Zero(geometry::parameter_count(camera.lens));
    camera.parameters.head<4>() << f_px, f_px, 0.5 * (camera.size_px.width - 1),
        0.5 * (camera.size_px.height - 1);
  }
  model.target_from_board = {{Eigen::Quaterniond::Identity(), {0, 0, distance_m}}};
  return model;
}

TEST(Registration, IsWhatTheMountingsSigmaIsInTheTargetsPicture) {
  const RigModel model = two_cameras(2);
  const RigLayout layout = layout_of(model, {});
  const int at = layout.cameras[1].extrinsics;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(layout.count, layout.count);
  covariance(at + 3, at + 3) = 1e-3 * 1e-3;  // a millimetre along x
  const Registration shifted = registration_of(model, layout, covariance, 1, {0});
  EXPECT_EQ(shifted.camera, "tof");
  EXPECT_NEAR(shifted.distance_m, 2, 1e-12);
  EXPECT_NEAR(shifted.median_px, 600 * 1e-3 / 2, 1e-6);
  EXPECT_NEAR(shifted.worst_px, shifted.median_px, 1e-6);
  covariance.setZero();
  covariance(at + 2, at + 2) =
      1e-3 * 1e-3;  // a milliradian about the axis: f r, at the outer cells
  const Registration rolled = registration_of(model, layout, covariance, 1, {0});
  const double x = (3.0 / 7) * 160 / 200, y = (2.0 / 5) * 120 / 200;
  EXPECT_NEAR(rolled.worst_px, 600 * 1e-3 * std::hypot(x, y), 1e-4);
}

TEST(Registration, LensAndMountingThatCancelAreCertain) {
  RigModel model = two_cameras(2);
  model.cameras[1].free = {2};  // cx
  const RigLayout layout = layout_of(model, {});
  const int cx = layout.cameras[1].intrinsics, shift = layout.cameras[1].extrinsics + 3;
  // A pixel of cx is 2 m / 200 px on the board, and the mounting takes it back.
  Eigen::VectorXd together = Eigen::VectorXd::Zero(layout.count);
  together[cx] = 1, together[shift] = -2.0 / 200;
  const Registration sure =
      registration_of(model, layout, together * together.transpose() * 1e-2, 1, {0});
  EXPECT_LT(sure.worst_px, 1e-4);
  together[shift] *= -1;
  const Registration unsure =
      registration_of(model, layout, together * together.transpose() * 1e-2, 1, {0});
  EXPECT_NEAR(unsure.median_px, 0.1 * 2 * 600 / 200, 1e-3);
}

}  // namespace
}  // namespace mixrig::calibration

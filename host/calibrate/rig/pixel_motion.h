// SPDX-License-Identifier: Apache-2.0
// How a pixel moves with the parameters of one camera and one view.
#pragma once

#include "host/calibrate/rig/board_render.h"
#include "host/math/estimation/verdict.h"

namespace mixrig::calibration {

/// Columns of one camera's own sum: [free intrinsics, six of camera_from_target, blur, six of the
/// view, three of the bend, light or depth knots].
struct CameraColumns {
  int free, extrinsics, blur, pose, bend, rest, count;
};
inline CameraColumns columns_of(const RigCamera& camera, int rest) {
  CameraColumns l{};
  l.free = static_cast<int>(camera.free.size());
  l.extrinsics = l.free, l.blur = l.extrinsics + 6, l.pose = l.blur + 1, l.bend = l.pose + 6;
  l.rest = l.bend + 3, l.count = l.rest + rest;
  return l;
}

/// Adds `by_px` times the derivative of a fixed board point's pixel by every parameter.
template <typename Row>
void add_motion(const Scene& scene, const ProjectedBoardPoint& projected, const Eigen::Vector2d& uv,
                const Eigen::RowVector2d& by_px, const CameraColumns& at, Row&& row) {
  for (int i = 0; i < at.free; ++i)
    row[i] += by_px.dot(projected.seen.d_parameters.col(scene.camera.free[i]));
  const Eigen::RowVector3d by_point = by_px * projected.seen.d_point;
  const Eigen::Vector3d turned = scene.camera.camera_from_target.rotation * projected.in_target;
  const Eigen::RowVector3d by_target =
      by_point * scene.camera.camera_from_target.rotation.toRotationMatrix();
  row.template segment<3>(at.extrinsics) -= (by_point * estimation::skew(turned)).transpose();
  row.template segment<3>(at.extrinsics + 3) += by_point.transpose();
  const Eigen::Vector3d about = projected.in_target - scene.target_from_board.translation_m;
  row.template segment<3>(at.pose) -= (by_target * estimation::skew(about)).transpose();
  row.template segment<3>(at.pose + 3) += by_target.transpose();
  const double x = 2 * uv.x() / scene.print.columns - 1, y = 2 * uv.y() / scene.print.rows - 1;
  const double out = by_target.dot(scene.target_from_board.rotation * Eigen::Vector3d::UnitZ());
  row.template segment<3>(at.bend) += out * Eigen::Vector3d(x * x, x * y, y * y);
}

}  // namespace mixrig::calibration

// SPDX-License-Identifier: Apache-2.0
// Residuals of the corners of a view.
#include <cmath>

#include "host/calibrate/rig/rig_terms.h"
#include "host/math/estimation/verdict.h"

namespace mixrig::calibration {
namespace {

constexpr double kCornerHuber = 2.5;  // sigmas

/// Derivatives of a pixel by the shared parameters and the pose of the view.
struct Derivatives {
  Eigen::Vector2d px;
  Eigen::MatrixXd rows;  ///< 2 x (shared + 6)
};

bool differentiate(const RigModel& model, const RigLayout& layout, const BoardPrint& print,
                   std::size_t camera_index, int view, const Eigen::Vector2d& uv, Derivatives& d) {
  const RigCamera& camera = model.cameras[camera_index];
  const RigLayout::Camera& place = layout.cameras[camera_index];
  const geometry::Pose& pose = model.target_from_board[view];
  const BoardPoint point = board_point(model, print.columns, print.rows, uv);
  const Eigen::Vector3d turned = pose.rotation * point.p_m;
  const Eigen::Vector3d in_target = turned + pose.translation_m;
  const Eigen::Matrix3d r = camera.camera_from_target.rotation.toRotationMatrix();
  const Eigen::Vector3d turned_again = r * in_target;
  const auto seen =
      geometry::project_with_jacobians(camera.lens, camera.parameters.data(),
                                       turned_again + camera.camera_from_target.translation_m);
  if (!seen) return false;
  d.px = seen->px;
  d.rows.setZero(2, layout.count + 6);
  for (std::size_t i = 0; i < camera.free.size(); ++i)
    d.rows.col(place.intrinsics + static_cast<int>(i)) = seen->d_parameters.col(camera.free[i]);
  if (place.extrinsics >= 0) {
    d.rows.middleCols<3>(place.extrinsics) = -seen->d_point * estimation::skew(turned_again);
    d.rows.middleCols<3>(place.extrinsics + 3) = seen->d_point;
  }
  const Eigen::Matrix<double, 2, 3> by_target = seen->d_point * r;
  if (layout.bend >= 0) {
    const double x = 2 * uv.x() / print.columns - 1, y = 2 * uv.y() / print.rows - 1;
    const Eigen::Vector2d out = by_target * (pose.rotation * Eigen::Vector3d::UnitZ());
    d.rows.middleCols<3>(layout.bend) = out * Eigen::RowVector3d(x * x, x * y, y * y);
  }
  d.rows.middleCols<3>(layout.count) = -by_target * estimation::skew(turned);
  d.rows.middleCols<3>(layout.count + 3) = by_target;
  return true;
}

}  // namespace

ViewFunction corner_terms(const BoardPrint& print, const SeenCorners& corners,
                          const std::vector<double>& sigma_px) {
  return [&print, &corners, sigma_px](const RigModel& model, const RigLayout& layout, int view) {
    const int n = layout.count;
    RowSum sum(n + 6);
    ViewTerm term;
    Derivatives d;
    for (std::size_t c = 0; c < model.cameras.size(); ++c)
      for (const SeenCorner& corner : corners[view][c]) {
        if (!differentiate(model, layout, print, c, view, corner.uv, d)) continue;
        const Eigen::Vector2d miss = (d.px - corner.px) / sigma_px[c];
        const double length = miss.norm();
        const double weight = length > kCornerHuber ? std::sqrt(kCornerHuber / length) : 1;
        for (int k = 0; k < 2; ++k) {
          auto row = sum.next();
          row.head(n + 6) = weight / sigma_px[c] * d.rows.row(k).transpose();
          row[n + 6] = weight * miss[k];
        }
        term.rows += 2;
      }
    term.sum = sum.sum();
    return term;
  };
}

}  // namespace mixrig::calibration

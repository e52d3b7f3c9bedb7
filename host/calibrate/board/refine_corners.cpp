// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/board/refine_corners.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "hal/base/order_statistics.h"
#include "host/calibrate/board/fit_corner.h"

namespace mixrig::calibration {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Half of the way to the next corner, but at most this: over larger windows lenses bend edges.
constexpr double kShare = 0.55, kMaxRadius_px = 16, kMinRadius_px = 3;

/// d pixel / d board metre at a point, from its neighbours in the view; nullopt where they are too
/// few or in one line.
std::optional<Matrix2d> local_scale(const std::vector<Vector3d>& points, const BoardView& view,
                                    std::size_t at, double reach_m) {
  Matrix2d normal = Matrix2d::Zero(), wanted = Matrix2d::Zero();
  const Vector2d here_m = points[static_cast<std::size_t>(view.ids[at])].head<2>();
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const Vector2d off_m = points[static_cast<std::size_t>(view.ids[i])].head<2>() - here_m;
    if (i == at || off_m.norm() > reach_m) continue;
    normal += off_m * off_m.transpose();
    wanted += (view.px[i] - view.px[at]) * off_m.transpose();
  }
  if (normal.determinant() < 1e-3 * std::pow(reach_m, 4)) return std::nullopt;
  return Matrix2d(wanted * normal.inverse());
}

}  // namespace

BoardView refine_corners(ImageView<const std::uint8_t> image, const BoardSpec& board,
                         const BoardView& rough) {
  const auto points = board_points_m(board);
  const bool tags = board.kind == BoardKind::kAprilgrid;
  const double reach_m = 1.5 * (tags ? board.square_m : pitch_m(board));
  const double share = board.kind == BoardKind::kCheckerboard ? kShare : 0.9;
  BoardView view;
  std::vector<double> blur, contrast, sigma;
  for (std::size_t i = 0; i < rough.ids.size(); ++i) {
    const auto scale = local_scale(points, rough, i, reach_m);
    if (!scale) continue;
    // The nearest thing besides the corner lies along a column, a row or between them.
    const double narrow =
        std::min({scale->col(0).norm(), scale->col(1).norm(),
                  std::abs(scale->determinant()) / scale->norm() * std::sqrt(2.0)});
    const double radius_px = std::min(share * clear_radius_m(board) * narrow, kMaxRadius_px);
    if (radius_px < kMinRadius_px) continue;
    const auto fit = fit_corner(image, rough.px[i], scale->col(0), scale->col(1), radius_px);
    if (!fit) continue;
    view.ids.push_back(rough.ids[i]);
    view.px.push_back(fit->px);
    blur.push_back(fit->blur_px);
    contrast.push_back(fit->contrast);
    sigma.push_back(fit->sigma_px);
  }
  view.blur_px = upper_median(blur);
  view.contrast = upper_median(contrast);
  view.sigma_px = upper_median(sigma);
  return view;
}

}  // namespace mixrig::calibration

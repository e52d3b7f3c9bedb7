// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/views/still_board.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "host/math/estimation/linear_fit.h"

namespace mixrig::calibration {
namespace {

constexpr std::size_t kLeastShared = 4;
constexpr double kChances = 3;

/// Corners that all views show, a column x and a column y for each view.
Eigen::MatrixXd shared_corners(const std::vector<BoardView>& views) {
  std::vector<int> ids = views.front().ids;
  for (const BoardView& view : views) {
    std::vector<int> both;
    std::set_intersection(ids.begin(), ids.end(), view.ids.begin(), view.ids.end(),
                          std::back_inserter(both));
    ids = std::move(both);
  }
  Eigen::MatrixXd px(static_cast<Eigen::Index>(ids.size()),
                     static_cast<Eigen::Index>(2 * views.size()));
  for (std::size_t v = 0; v < views.size(); ++v) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      while (views[v].ids[at] != ids[i]) ++at;
      px.block<1, 2>(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(2 * v)) =
          views[v].px[at].transpose();
    }
  }
  return px;
}

}  // namespace

BoardMotion board_motion(const std::vector<BoardView>& views) {
  BoardMotion motion;
  if (views.size() < 2) return motion;
  Eigen::MatrixXd px = shared_corners(views);
  const Eigen::Index n = px.rows(), count = static_cast<Eigen::Index>(views.size());
  if (n < static_cast<Eigen::Index>(kLeastShared)) return motion;
  Eigen::MatrixXd design(n, 3);  // 1, x, y about the middle
  design.col(0).setOnes();
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
    for (Eigen::Index v = 0; v < count; ++v) mean += px.col(2 * v + axis);
    mean /= static_cast<double>(count);
    for (Eigen::Index v = 0; v < count; ++v) px.col(2 * v + axis) -= mean;
    design.col(1 + axis) = mean.array() - mean.mean();
  }
  const Eigen::MatrixXd affine = design * estimation::solve_columns(design, px);
  const auto corners = static_cast<double>(n);
  for (Eigen::Index v = 0; v < count; ++v)
    motion.most_px =
        std::max(motion.most_px, std::sqrt(affine.middleCols(2 * v, 2).squaredNorm() / corners));
  const double free = 2.0 * (corners - 3) * static_cast<double>(count - 1);
  motion.noise_px = std::sqrt((px - affine).squaredNorm() / free);
  motion.chance_px = motion.noise_px * std::sqrt(6 / corners);
  motion.corners = static_cast<int>(n);
  return motion;
}

bool is_still(const BoardMotion& motion, double rest_px) {
  return motion.corners > 0 && motion.most_px <= std::hypot(rest_px, kChances * motion.chance_px);
}

}  // namespace mixrig::calibration

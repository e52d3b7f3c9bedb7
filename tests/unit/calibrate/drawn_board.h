// SPDX-License-Identifier: Apache-2.0
// Boards drawn by a camera that shares no code with the pipeline: a pinhole behind a division lens
// (r_ideal = r / (1 + k r^2)), both directions in closed form.
#pragma once

#include <random>
#include <vector>

#include "hal/base/image.h"
#include "host/calibrate/board/board.h"
#include "host/math/geometry/pose.h"

namespace mixrig::test {

struct DrawnCamera {
  Size size_px{640, 480};
  double focal_px = 520, cx_px = 322.3, cy_px = 236.8;
  double k = -0.2;  ///< of the division lens; negative for a barrel

  Eigen::Vector2d project(const Eigen::Vector3d& p) const;
  /// Ray of a pixel as (x/z, y/z).
  Eigen::Vector2d ray(const Eigen::Vector2d& px) const;
};

struct DrawnLook {
  double blur_px = 0.6;  ///< Gaussian blur, in addition to the pixel's area
  double noise = 2;      ///< grey levels
  double black = 30, white = 210;
  double shading = 0.3;         ///< fall of the light from the left to the right
  bool first_is_white = false;  ///< the top left square of a checkerboard or ChArUco; else black
};

Image<std::uint8_t> draw_board(const calibration::BoardSpec& board, const DrawnCamera& camera,
                               const geometry::Pose& camera_from_board, const DrawnLook& look,
                               unsigned seed);
/// True pixels of the board's points, by id.
std::vector<Eigen::Vector2d> true_px(const calibration::BoardSpec& board, const DrawnCamera& camera,
                                     const geometry::Pose& camera_from_board);
/// Pose of the board: turned by a rotation vector, its middle at `middle_m` before the camera.
geometry::Pose board_pose(const calibration::BoardSpec& board, const Eigen::Vector3d& turn_rad,
                          const Eigen::Vector3d& middle_m);
/// Poses of many kinds: tilted to all sides, over the whole picture, near and far.
std::vector<geometry::Pose> varied_poses(const calibration::BoardSpec& board, int count,
                                         unsigned seed, double distance_m);

}  // namespace mixrig::test

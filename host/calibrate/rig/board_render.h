// SPDX-License-Identifier: Apache-2.0
// Renders the board as one camera sees it in one view: ink and light at every pixel on it.
#pragma once

#include <vector>

#include "host/calibrate/rig/board_texture.h"
#include "host/calibrate/rig/rig_model.h"

namespace mixrig::calibration {

constexpr int kLight = 6;  ///< terms of the light over the board, separately for ink and paper
using LightRow = Eigen::Matrix<double, kLight, 1>;

/// One view of one camera, ready for rendering.
struct Scene {
  const RigModel& model;
  const RigCamera& camera;
  const BoardPrint& print;
  geometry::Pose target_from_board, camera_from_board;
  Eigen::Matrix3d r, board_from_camera;  ///< camera_from_board's rotation and its inverse
  Eigen::Vector3d eye;                   ///< the camera's position in board axes
};

/// A pixel on the board.
struct Sample {
  int x = 0, y = 0;
  Eigen::Vector2d uv;
  double ink = 0, ink_by_blur = 0;
  bool edge = false;             ///< the ink changes here: only such pixels depend on the geometry
  Eigen::RowVector2d ink_by_px;  ///< derivative of ink by the pixel position
  LightRow light;                ///< 1, x, y, x^2, x y, y^2 on the board, times falloff
};

Scene make_scene(const RigModel& model, const BoardPrint& print, std::size_t camera, int view);

/// Projection of a board point, with the derivative of the pixel by the board's coordinates.
struct ProjectedBoardPoint {
  geometry::Projection seen;
  Eigen::Vector3d in_target;  ///< the point
  Eigen::Matrix2d px_by_uv;
};
/// False where the lens has no pixel for it.
bool project_board_point(const Scene& scene, const Eigen::Vector2d& uv,
                         ProjectedBoardPoint& projected);

struct BoardPixel {
  int x = 0, y = 0;
};
/// Pixels on the board, row by row, without those at its border.
std::vector<BoardPixel> pixels_on_board(const Scene& scene);

/// Renders pixels that are given row by row; those that do not meet the board are left out. With
/// `own_light` the lamp is next to the lens, as in a depth camera: light falls off with the square
/// of the distance and with the cosine.
std::vector<Sample> render(const Scene& scene, const std::vector<BoardPixel>& pixels,
                           bool own_light);

}  // namespace mixrig::calibration

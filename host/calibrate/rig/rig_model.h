// SPDX-License-Identifier: Apache-2.0
// A rig and the board before it: what the joint calibrations solve for.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "host/math/geometry/any_camera.h"
#include "host/math/geometry/pose.h"

namespace mixrig::calibration {

struct RigCamera {
  std::string name;
  geometry::LensKind lens = geometry::LensKind::kPinhole;
  Size size_px;
  Eigen::VectorXd parameters;         ///< geometry::parameters_of()
  std::vector<int> free;              ///< indices of the parameters to solve for
  geometry::Pose camera_from_target;  ///< identity for the first camera
  double blur_px = 0.5;               ///< sigma of the lens blur, without the pixel's own area
};

/// Systematic depth error at knots over the true distance, a natural cubic spline.
struct DepthCurve {
  std::vector<double> knots_m, error_m;
};

struct RigModel {
  std::vector<RigCamera> cameras;                 ///< the first is the target camera
  std::vector<geometry::Pose> target_from_board;  ///< one for each view
  double square_m = 0;
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();  ///< w = bend . (x^2, x y, y^2), metres; x, y run
                                                   ///< from -1 to 1 over the board
  DepthCurve depth;                                ///< measured - true distance of the depth camera
};

/// Indices of a model's parameters in the vector of a step: cameras in order (free intrinsics, six
/// of camera_from_target except for the first, blur), bend, depth. Poses are turned and moved as
/// estimation::pose_error() says.
struct RigLayout {
  struct Camera {
    int intrinsics = 0, extrinsics = -1, blur = -1;
  };
  std::vector<Camera> cameras;
  int bend = -1, depth = -1, count = 0;
};
struct RigSwitches {
  bool blur = false, bend = false, depth = false;
};
RigLayout layout_of(const RigModel& model, const RigSwitches& switches);

/// Adds a step of the shared parameters, and one of six to each view's pose.
void apply_step(RigModel& model, const RigLayout& layout, const Eigen::VectorXd& shared,
                const std::vector<Eigen::Matrix<double, 6, 1>>& views);

/// Point of the board at (u, v), in squares, with its derivatives by u and v.
struct BoardPoint {
  Eigen::Vector3d p_m;
  Eigen::Matrix<double, 3, 2> d_uv;
};
BoardPoint board_point(const RigModel& model, int columns, int rows, const Eigen::Vector2d& uv);

/// Values of the natural cubic splines that are 1 at one knot and 0 at the others. Beyond the end
/// knots they keep their values there, as in calibration_file::DepthError.
void spline_basis(const std::vector<double>& knots, double at, Eigen::VectorXd& values);

}  // namespace mixrig::calibration

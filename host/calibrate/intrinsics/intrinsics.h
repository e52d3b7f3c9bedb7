// SPDX-License-Identifier: Apache-2.0
// Intrinsics of one camera from views of a board, with their covariance and held-out error.
#pragma once

#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/calibrate/board/board.h"
#include "host/calibrate/board/detect_board.h"
#include "host/calibrate/board/image_circle.h"
#include "host/calibrate/intrinsics/bundle.h"

namespace mixrig::calibration {

struct ObservedView {
  std::string name;
  BoardView board;
};

struct IntrinsicsOptions {
  geometry::LensKind kind = geometry::LensKind::kPinhole;
  /// Lens coefficients to solve for: 0, 2 (k1 k2), 4 (p1 p2 too), 5 (k3 too), 8 (k4 k5 k6 too) for
  /// a pinhole; 0, 2, 4 for a fisheye. -1: as many as lower the error on views left out of the fit.
  /// A pinhole chosen by its number may fold within the picture: see validate().
  int lens_terms = -1;
  bool hold_center = false;  ///< keep the principal point in the middle of the picture
  /// Image circle of a fisheye. Points beyond it are left out, and the camera's largest angle
  /// becomes the angle of its rim.
  std::optional<ImageCircle> circle;
};

/// Result for one view.
struct ViewFit {
  std::string name;
  bool used = false;
  std::string why_not;  ///< the reason in one line where it is not used
  double rms_px = 0;    ///< root mean square distance, over the points in use
  int points = 0, points_out = 0;
  geometry::Pose camera_from_board;
  std::vector<Eigen::Vector2d> px, residual_px;  ///< observed, and observed minus projected
};

struct Intrinsics {
  geometry::AnyCamera camera;
  Eigen::MatrixXd covariance;  ///< of geometry::parameters_of(camera); zero rows where held
  int lens_terms = 0;
  double rms_px = 0;       ///< root mean square residual of the points in use
  double sigma_px = 0;     ///< noise of one coordinate, from the residuals
  double held_out_px = 0;  ///< root mean square over views left out of the fit (5 folds); 0 where
                           ///< there are too few views to leave any out
  int points = 0, points_out = 0;
  int points_beyond = 0;        ///< points beyond the image circle; points_out does not count them
  double point_angle_rad = 0;   ///< largest angle from the axis of a point in use
  bool ends_at_points = false;  ///< the lens folds inside the picture: its largest angle is
                                ///< kBeyondPoints_rad (lens_domain.h) beyond point_angle_rad
  std::optional<ImageCircle> circle;  ///< IntrinsicsOptions::circle
  std::vector<ViewFit> views;         ///< results of all given views, in their order
  Bundle bundle;                      ///< the solved views in use
};

/// Solves by robust least squares: starts from a search over focal lengths, leaves out points
/// beyond five sigma, blurred views and views far worse than the others, and estimates sigma from
/// what remains. Errors: kData where the views cannot determine the parameters: fewer than three
/// views, all alike, a board that is not as stated, pictures of two cameras; the line names the
/// reason and what to do. Views of two cameras are refused where each group by itself fits them at
/// least 1.25 times better than one camera does (three views or more a group); fewer foreign views
/// are left out.
///
/// A fisheye that folds inside its image circle is refused. Without a circle the whole picture is
/// image, and a lens that folds inside it is only taken where there is no other: then its largest
/// angle is just beyond the outermost point, since the lens is not known farther out.
Result<Intrinsics> solve_intrinsics(const BoardSpec& board, Size size_px,
                                    const std::vector<ObservedView>& views,
                                    const IntrinsicsOptions& options);

/// Root mean square residual (px) of the views under a given camera, with only their poses fitted;
/// infinite where the fit fails.
double pose_only_rms_px(const geometry::AnyCamera& camera, const BoardSpec& board,
                        const std::vector<ObservedView>& views);

}  // namespace mixrig::calibration

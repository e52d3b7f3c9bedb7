// SPDX-License-Identifier: Apache-2.0
// Aligns a room's patches with a picture, which gives the camera's pose.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "host/math/geometry/any_camera.h"
#include "host/math/geometry/pose.h"
#include "host/pose/tracker/grey_pyramid.h"
#include "host/pose/tracker/patch_choice.h"
#include "host/pose/tracker/patch_map.h"

namespace mixrig::tracking {

struct AlignOptions {
  int patches = 300;           ///< largest number per picture
  double coarsest_rad = 0.06;  ///< largest angle of a pixel on the first level
  int finest = 0;              ///< the last level
  int iterations = 8;          ///< largest number per level
};

/// Fit of a pose to a picture.
struct PatchFit {
  geometry::Pose camera_from_room;
  /// Covariance of (rotation vector rad, translation m), with R = exp(w) * R_estimate.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  int visible = 0;       ///< patches of the room expected in the picture, on the finest level
  int inliers = 0;       ///< visible patches that match in grey values and position
  double offset_px = 0;  ///< median distance of inliers from their expected place, finest level
  double sigma_m() const;
  double sigma_rad() const;
};

/// Gauss-Newton on the grey values of all patches together, from coarse to fine (direct alignment;
/// gradients are taken from the room: inverse compositional, Baker and Matthews 2004). Each patch
/// has its own brightness and contrast. A patch is weighted by the information about its own shift
/// and by Tukey's function of its offset, and is left out if its grey values do not correlate with
/// the picture's (people, changed lamps). Not thread-safe; does not allocate after construction.
class PatchAlign {
 public:
  /// `map` and `camera` must outlive it.
  PatchAlign(const PatchMap& map, const geometry::AnyCamera& camera, const AlignOptions& options);

  /// Aligns from a start pose whose error is at most about 1.5 pixels of the coarsest level.
  PatchFit align(const GreyPyramid& picture, const geometry::Pose& camera_from_room);
  /// The first, coarsest level.
  int coarsest() const { return coarsest_; }
  /// Aligns on the given levels.
  PatchFit align(const GreyPyramid& picture, const geometry::Pose& camera_from_room, int coarsest,
                 int finest);

  /// State of a patch on the last level.
  struct Seen {
    const Patch* patch = nullptr;
    Eigen::Vector2d px = Eigen::Vector2d::Zero();           ///< pixel of level 0
    float correlation = 0;                                  ///< correlation of grey values, -1 to 1
    Eigen::Vector2d offset = Eigen::Vector2d::Zero();       ///< in pixels of the patch
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  ///< of the offset
    Eigen::Matrix<double, 2, 6> jacobian;  ///< offset by (rotation, translation) of the pose
    double weight = 0;
    bool in_picture = false;
  };
  const std::vector<Seen>& seen() const { return seen_; }

 private:
  void look(const GreyPyramid& picture, const geometry::Pose& camera_from_room, int k, Seen& s);
  double weigh(double least_correlation);
  bool step(geometry::Pose& camera_from_room, double& moved);

  const PatchMap& map_;
  const geometry::AnyCamera& camera_;
  const AlignOptions options_;
  Eigen::VectorXd parameters_;
  int coarsest_;
  PatchChoice choice_;
  std::vector<Seen> seen_;
  std::vector<double> distances_;
};

}  // namespace mixrig::tracking

// SPDX-License-Identifier: Apache-2.0
// The pose at which a room's patches lie on a picture.
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
  int patches = 300;           ///< of a picture, most
  double coarsest_rad = 0.06;  ///< of a pixel, at most, on the level that is begun with
  int finest = 0;              ///< and ended with
  int iterations = 8;          ///< of a level, most
};

/// How well a pose explains a picture.
struct PatchFit {
  geometry::Pose camera_from_room;
  /// Of (rotation vector rad, translation m): R = exp(w) * R_estimate.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  int visible = 0;       ///< patches that the room has in the picture, on the finest level
  int inliers = 0;       ///< of them those that look and lie as they should
  double offset_px = 0;  ///< median distance of inliers from where they should lie, finest level
  double sigma_m() const;
  double sigma_rad() const;
};

/// Gauss-Newton on the grey values of all patches together, from coarse to fine (direct alignment;
/// the gradients are the room's: inverse compositional, Baker and Matthews 2004). Each patch has
/// its own brightness and contrast. A patch counts by its information about its own shift, falls
/// out where its grey values do not correlate with the picture's (people, lamps that changed), and
/// is weighted by Tukey's function of how far it lies off. Not thread-safe; does not allocate after
/// construction.
class PatchAlign {
 public:
  /// Map and camera must outlive it.
  PatchAlign(const PatchMap& map, const geometry::AnyCamera& camera, const AlignOptions& options);

  /// From a pose up to about 1.5 pixels of the coarsest level off.
  PatchFit align(const GreyPyramid& picture, const geometry::Pose& camera_from_room);
  /// The level that is begun with.
  int coarsest() const { return coarsest_; }
  /// The same on chosen levels.
  PatchFit align(const GreyPyramid& picture, const geometry::Pose& camera_from_room, int coarsest,
                 int finest);

  /// What became of each patch of the last level.
  struct Seen {
    const Patch* patch = nullptr;
    Eigen::Vector2d px = Eigen::Vector2d::Zero();           ///< of level 0
    float correlation = 0;                                  ///< of grey values, -1 to 1
    Eigen::Vector2d offset = Eigen::Vector2d::Zero();       ///< in pixels of the patch
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  ///< of the offset
    Eigen::Matrix<double, 2, 6> jacobian;  ///< of the offset by (rotation, translation) of the pose
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

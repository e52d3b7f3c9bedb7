// SPDX-License-Identifier: Apache-2.0
// Residuals of the depth pictures of a view.
#pragma once

#include <vector>

#include "host/calibrate/rig/pixel_motion.h"
#include "host/calibrate/rig/rig_terms.h"

namespace mixrig::calibration {

/// Standard deviation of depth on paper and on ink.
struct DepthScatter {
  double paper_m = 0, ink_m = 0;
};
DepthScatter depth_scatter(const Scene& scene, const std::vector<Sample>& samples,
                           const ViewPictures& seen);

/// Converts a depth value of the picture to distance along the ray on which the camera sees
/// `point_m` (board axes).
double along_ray(const Scene& scene, const ViewPictures& seen, double depth_m,
                 const Eigen::Vector3d& point_m);

/// Sums the depth residuals of a picture in the columns of `at`, and adds their number to `rows`.
Eigen::MatrixXd depth_sums(const Scene& scene, const std::vector<Sample>& samples,
                           const ViewPictures& seen, const DepthScatter& sigma,
                           const CameraColumns& at, long& rows);

}  // namespace mixrig::calibration

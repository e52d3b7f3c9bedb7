// SPDX-License-Identifier: Apache-2.0
// Adjusts poses and places together by least squares of their rays (bundle adjustment, Triggs et
// al. 1999).
#pragma once

#include <vector>

#include "hal/base/result.h"
#include "host/math/estimation/points/bearing.h"
#include "host/math/geometry/pose.h"

namespace mixrig::reconstruction {

struct BundleRay {
  int view = 0, place = 0;
  estimation::Bearing ray;
};

/// Measured distance between a place and a view.
struct BundleRange {
  int view = 0, place = 0;
  double range = 0, sigma = 0;
};

struct Bundle {
  std::vector<geometry::Pose> camera_from_map;
  std::vector<bool> fixed;  ///< views that stay fixed; at least one
  std::vector<Eigen::Vector3d> places;
  std::vector<BundleRay> rays;
  std::vector<BundleRange> ranges;
};

/// Minimises ray_error() with Huber's loss from 2 sigmas on, and the errors of the ranges with
/// Cauchy's. Views and places move; without ranges and two fixed views the scale is free and stays
/// near its start. Computes about the middle of the places. Errors, kData, with nothing moved: a
/// number that is not finite, or the solver fails.
Result<void> adjust(Bundle& bundle, int iterations, int threads);

}  // namespace mixrig::reconstruction

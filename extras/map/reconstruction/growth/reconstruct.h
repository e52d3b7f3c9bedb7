// SPDX-License-Identifier: Apache-2.0
// Structure from motion of one calibrated camera (Frahm, Koeser, Grest and Koch 2005, section 4.1).
#pragma once

#include "extras/map/reconstruction/features/feature_tracks.h"
#include "extras/map/reconstruction/growth/map_scale.h"
#include "extras/map/reconstruction/maps/learned_map.h"
#include "hal/base/result.h"

namespace mixrig::reconstruction {

struct ReconstructOptions {
  /// Most pairs of the two start pictures, as a share of those that agree with a motion, that
  /// rotation alone may explain.
  double most_turned_share = 0.7;
  double least_angle_rad = 0.004;  ///< least angle between the rays of a point
  int least_views = 3;             ///< least number of key pictures that see a point
  double most_sigma_share = 0.08;  ///< limit relative to a point's distance, along its worst axis
  int threads = 1;
};

/// Starts from two key pictures with parallax (five-point method). Adds each other key picture by
/// its pose from known points, triangulates new points, and adjusts poses and points together:
/// those of the neighbours at each step, all at the end. Then aligns every track to its mean
/// appearance and adjusts all pictures together, with the depth if there is some, which makes small
/// motions accurate and the map metric. Leaves out points that few pictures see, that contradict
/// them, or whose depth is uncertain, and with these the points on moving people. camera and
/// calibration_hash are left empty. Errors: kData where the camera does not move enough (it only
/// rotates, or fewer than a quarter of the tracked points get a depth), or fewer than half of the
/// key pictures fit together.
Result<LearnedMap> reconstruct(const FeatureTracks& tracks, const geometry::AnyCamera& camera,
                               const ReconstructOptions& options = {},
                               const DepthRecord* depth = nullptr);

}  // namespace mixrig::reconstruction

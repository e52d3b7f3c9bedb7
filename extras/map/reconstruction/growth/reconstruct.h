// SPDX-License-Identifier: Apache-2.0
// Structure from motion of one calibrated camera (Frahm, Koeser, Grest and Koch 2005, section 4.1).
#pragma once

#include "extras/map/reconstruction/features/feature_tracks.h"
#include "extras/map/reconstruction/growth/map_scale.h"
#include "extras/map/reconstruction/maps/learned_map.h"
#include "hal/base/result.h"

namespace mixrig::reconstruction {

struct ReconstructOptions {
  /// Of the two pictures that are begun with: so many of the places that agree with a motion are
  /// explained by turning alone, at most.
  double most_turned_share = 0.7;
  double least_angle_rad = 0.004;  ///< between the rays of a place, at least
  int least_views = 3;             ///< key pictures that see a place
  double most_sigma_share = 0.08;  ///< of a place's distance, along its worst axis
  int threads = 1;
};

/// Two key pictures with parallax give the start (five-point method); each other key picture is
/// added by its pose from known places, new places are triangulated, and poses and places are
/// adjusted together, of the neighbours at each step and of all at the end. Then every track is
/// aligned to its mean look, and all pictures are adjusted together, with the depth where there is
/// some: a small motion is well known then, and the map is in metres. Places that few pictures see,
/// that contradict them, or whose depth is not known are left out; so are those of people, who
/// move. camera and calibration_hash are left empty. Errors: kData where the camera does not move
/// enough (by turning alone, or fewer than a quarter of the followed places get a depth), or fewer
/// than half of the key pictures fit together.
Result<LearnedMap> reconstruct(const FeatureTracks& tracks, const geometry::AnyCamera& camera,
                               const ReconstructOptions& options = {},
                               const DepthRecord* depth = nullptr);

}  // namespace mixrig::reconstruction

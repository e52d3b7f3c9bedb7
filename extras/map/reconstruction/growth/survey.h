// SPDX-License-Identifier: Apache-2.0
// Adjusts all pictures together, after the key pictures have given a start. Private to this module.
#pragma once

#include <optional>
#include <vector>

#include "extras/map/reconstruction/growth/growth.h"

namespace mixrig::reconstruction {

/// Poses are camera_from_map of pictures; tracks, places and covariances as in Growth.
struct Survey {
  std::vector<std::optional<geometry::Pose>> poses;
  std::vector<FeatureTrack> tracks;
  std::vector<std::optional<Eigen::Vector3d>> places;
  std::vector<Eigen::Matrix3d> covariances;
  double residual_px = 0, sigma_scale = 1;
  std::size_t followed = 0, known = 0;  ///< tracks that enough pictures see; those with a place
  std::optional<MapScale> scale;        ///< if set, poses and places are in metres
};

/// Aligns each track to its mean appearance (align_looks()), rotated by the poses, and adjusts
/// poses and places of at most 200 pictures, evenly chosen, to the result; the other pictures get
/// their poses from the places. Sigmas are those of the alignment, scaled by the residuals. Where
/// `depth` (may be null) gives the scale (scale_by_depth()), the measured distances are adjusted
/// too, each with a sigma of 1 %.
Survey survey(const FeatureTracks& tracks, const geometry::AnyCamera& camera, const Growth& grown,
              const ReconstructOptions& options, const DepthRecord* depth);

}  // namespace mixrig::reconstruction

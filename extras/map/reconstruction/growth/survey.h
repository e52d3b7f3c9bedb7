// SPDX-License-Identifier: Apache-2.0
// All pictures together, once the key pictures have given a start. Private to this module.
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
  std::size_t followed = 0, known = 0;  ///< tracks that enough pictures see; places of them
  std::optional<MapScale> scale;        ///< poses and places are in metres
};

/// Each track is aligned to its mean look with what the poses say how it turns (align_looks()), and
/// poses and places are adjusted to that, of at most 200 pictures, evenly; the others get their
/// poses from the places. Sigmas are those of the alignment times what the residuals say. Where
/// `depth` (may be null) tells the scale (scale_by_depth()), the distances that it measured are
/// adjusted too, each with 1 % of sigma.
Survey survey(const FeatureTracks& tracks, const geometry::AnyCamera& camera, const Growth& grown,
              const ReconstructOptions& options, const DepthRecord* depth);

}  // namespace mixrig::reconstruction

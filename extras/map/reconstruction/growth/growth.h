// SPDX-License-Identifier: Apache-2.0
// State of the reconstruction while it grows. Private to this module.
#pragma once

#include <optional>
#include <vector>

#include "extras/map/reconstruction/growth/reconstruct.h"
#include "extras/map/reconstruction/views/bundle.h"
#include "extras/map/reconstruction/views/rays.h"
#include "extras/map/reconstruction/views/resection.h"

namespace mixrig::reconstruction {

/// A track in a key picture.
struct KeySighting {
  int key = 0;
  Eigen::Vector2d px;
  estimation::Bearing ray;
};

/// Poses are camera_from_map of the key pictures; places, covariances and sightings are those of
/// the tracks.
struct Growth {
  std::vector<std::optional<geometry::Pose>> poses;
  std::vector<std::optional<Eigen::Vector3d>> places;
  std::vector<Eigen::Matrix3d> covariances;
  std::vector<std::vector<KeySighting>> sightings;
  std::vector<int> same_as;  ///< for each track the one that has its sightings now
  double residual_px = 0;
  std::size_t followed = 0, known = 0;  ///< tracks that enough key pictures see; those with a place
};

/// Reconstructs the key pictures alone, otherwise like reconstruct().
Result<Growth> grow(const FeatureTracks& tracks, const geometry::AnyCamera& camera,
                    const ReconstructOptions& options);

}  // namespace mixrig::reconstruction

// SPDX-License-Identifier: Apache-2.0
// Finds a camera in a learned map by the appearance of its points (Frahm, Koeser, Grest and Koch
// 2005, section 4.2).
#pragma once

#include <vector>

#include "extras/map/reconstruction/maps/learned_map.h"
#include "host/pose/tracker/first_pose.h"

namespace mixrig::reconstruction {

/// Matches SIFT features of the picture to the map's descriptors (ratio to the best of another
/// point, Lowe 2004), estimates a pose by P3P under random sampling, and aligns the patches from
/// there. Ignores the search field. Allocates; not thread-safe.
class MapFinder final : public tracking::PoseFinder {
 public:
  /// `patches` and `camera` must outlive it; the map is copied.
  MapFinder(const LearnedMap& map, const tracking::PatchMap& patches,
            const geometry::AnyCamera& camera, const tracking::AlignOptions& options);

  std::optional<tracking::PatchFit> find(const tracking::GreyPyramid& picture,
                                         const tracking::SearchField& field) const override;

 private:
  std::vector<Eigen::Vector3d> places_;
  std::vector<MapDescriptor> descriptors_;
  const tracking::PatchMap& patches_;
  const geometry::AnyCamera& camera_;
  tracking::AlignOptions options_;
};

}  // namespace mixrig::reconstruction

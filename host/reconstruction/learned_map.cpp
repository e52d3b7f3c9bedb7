// SPDX-License-Identifier: Apache-2.0
#include "host/reconstruction/learned_map.h"

#include <algorithm>

namespace mixrig::reconstruction {

double extent_of(const std::vector<trajectory::TimedPose>& path) {
  double most = 0;
  for (const auto& a : path)
    for (const auto& b : path)
      most = std::max(
          most, (a.world_from_body.translation_m - b.world_from_body.translation_m).squaredNorm());
  return std::sqrt(most);
}

void rescale(LearnedMap& map, double factor) {
  for (MapPoint& p : map.points) p.place *= factor, p.covariance *= factor * factor;
  for (MapKey& k : map.keys) k.map_from_camera.translation_m *= factor;
  for (auto& pose : map.path) pose.world_from_body.translation_m *= factor;
}

}  // namespace mixrig::reconstruction

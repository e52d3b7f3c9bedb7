// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/maps/learned_map.h"

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

geometry::Pose carried(const geometry::Pose& pose, const estimation::Similarity& by) {
  return {(by.pose.rotation * pose.rotation).normalized(), by * pose.translation_m};
}

LearnedMap carried(const LearnedMap& map, const estimation::Similarity& by) {
  LearnedMap out = map;
  const Eigen::Matrix3d turn = by.scale * by.pose.rotation.toRotationMatrix();
  for (MapPoint& p : out.points) {
    p.place = by * p.place;
    p.covariance = turn * p.covariance * turn.transpose();
  }
  for (MapKey& k : out.keys) k.map_from_camera = carried(k.map_from_camera, by);
  for (auto& pose : out.path) pose.world_from_body = carried(pose.world_from_body, by);
  return out;
}

}  // namespace mixrig::reconstruction

// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/maps/map_join.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "host/math/estimation/decompositions.h"

namespace mixrig::reconstruction {
namespace {

/// Poses of both cameras at one time, each in its own map.
std::vector<std::pair<geometry::Pose, geometry::Pose>> common_poses(
    const LearnedMap& first, const LearnedMap& second, const trajectory::Alignment& alignment) {
  const trajectory::Trajectory path(first.path);
  std::vector<std::pair<geometry::Pose, geometry::Pose>> poses;
  for (const auto& b : second.path)
    if (const auto a = path.at(b.t_s + alignment.time_offset_s))
      poses.emplace_back(*a, b.world_from_body);
  return poses;
}

}  // namespace

Result<MapJoin> join(const LearnedMap& first, const LearnedMap& second) {
  const auto aligned =
      trajectory::align(trajectory::Trajectory(first.path), trajectory::Trajectory(second.path));
  if (!aligned.usable())
    return Error{ErrorCode::kData, "the maps cannot be joined: " + aligned.verdict.reason};
  MapJoin join;
  join.alignment = aligned.value;
  const auto& lever = join.alignment.lever_and_scale;
  if (!lever.usable())
    return Error{ErrorCode::kData, "the maps cannot be joined: their common scale is not known: " +
                                       lever.verdict.reason};
  join.scale_sigma = std::sqrt(lever.covariance(3, 3)) / lever.value.scale;
  constexpr double kMostScaleSigma = 0.2, kPercent = 100;
  if (!(lever.value.scale > 0) || !(join.scale_sigma < kMostScaleSigma))
    return Error{ErrorCode::kData,
                 fmt::format("the maps cannot be joined: their common scale is known to {:.0f} % "
                             "only: record a take in which the rig moves more",
                             kPercent * join.scale_sigma)};
  const auto poses = common_poses(first, second, join.alignment);
  if (poses.empty())
    return Error{
        ErrorCode::kData,
        "the maps cannot be joined: they have no time in common: learn both from one take"};
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  for (const auto& [a, b] : poses)
    cross += (a.rotation * join.alignment.a_from_b * b.rotation.conjugate()).toRotationMatrix();
  estimation::Similarity& map = join.first_from_second;
  map.scale = lever.value.scale;
  map.pose.rotation = estimation::fit_rotation(cross).rotation;
  const auto offset = [&](const auto& pair) -> Eigen::Vector3d {
    return pair.first * lever.value.lever_m -
           map.scale * (map.pose.rotation * pair.second.translation_m);
  };
  for (const auto& pair : poses)
    map.pose.translation_m += offset(pair) / static_cast<double>(poses.size());
  double squares = 0;
  for (const auto& pair : poses) squares += (offset(pair) - map.pose.translation_m).squaredNorm();
  join.spread = std::sqrt(squares / static_cast<double>(poses.size()));
  return join;
}

LearnedMap in_first(const LearnedMap& second, const LearnedMap& first, const MapJoin& join) {
  LearnedMap map = carried(second, join.first_from_second);
  for (MapKey& k : map.keys) k.time_s += join.alignment.time_offset_s;
  for (auto& p : map.path) p.t_s += join.alignment.time_offset_s;
  map.scale = first.scale, map.room = first.room;
  if (map.scale) map.scale->sigma = std::hypot(map.scale->sigma, join.scale_sigma);
  return map;
}

}  // namespace mixrig::reconstruction

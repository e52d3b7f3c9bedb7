// SPDX-License-Identifier: Apache-2.0
#include "host/reconstruction/reconstruct.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "host/reconstruction/growth.h"

namespace mixrig::reconstruction {
namespace {

/// Poses of all pictures, from the places that were followed in them.
std::vector<trajectory::TimedPose> path_of(const FeatureTracks& tracks,
                                           const geometry::AnyCamera& camera, const Growth& grown) {
  struct Seen {
    std::vector<Eigen::Vector3d> places;
    std::vector<estimation::Bearing> rays;
  };
  std::vector<Seen> seen(tracks.times_s.size());
  for (std::size_t t = 0; t < tracks.tracks.size(); ++t) {
    if (!grown.places[t]) continue;
    for (const Sighting& s : tracks.tracks[t].seen) {
      const auto ray = ray_of(camera, s.px, s.sigma_px);
      if (!ray) continue;
      seen[static_cast<std::size_t>(s.picture)].places.push_back(*grown.places[t]);
      seen[static_cast<std::size_t>(s.picture)].rays.push_back(*ray);
    }
  }
  std::vector<trajectory::TimedPose> path;
  std::size_t key = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    while (key + 1 < tracks.keys.size() && tracks.keys[key + 1].picture <= static_cast<int>(i))
      ++key;
    std::optional<Resection> pose;
    if (grown.poses[key] && tracks.keys[key].picture == static_cast<int>(i)) {
      path.push_back({tracks.times_s[i], geometry::inverse(*grown.poses[key])});
      continue;
    }
    const auto before = path.empty() ? std::optional<geometry::Pose>()
                                     : geometry::inverse(path.back().world_from_body);
    constexpr std::size_t kFewest = 20;
    if (before) pose = refine_pose(seen[i].places, seen[i].rays, *before);
    if (!pose || pose->inliers.size() < kFewest || 2 * pose->inliers.size() < seen[i].places.size())
      pose = find_pose(seen[i].places, seen[i].rays);
    if (pose && pose->inliers.size() >= kFewest &&
        2 * pose->inliers.size() >= seen[i].places.size())
      path.push_back({tracks.times_s[i], geometry::inverse(pose->camera_from_map)});
  }
  return path;
}

/// Places with their look, descriptors and the poses of key pictures; the first solved key is the
/// origin.
LearnedMap map_of(const FeatureTracks& tracks, const Growth& grown) {
  LearnedMap map;
  map.pictures = static_cast<int>(tracks.times_s.size());
  map.residual_px = grown.residual_px;
  std::vector<int> number_of_key(tracks.keys.size(), -1);
  for (std::size_t k = 0; k < tracks.keys.size(); ++k) {
    if (!grown.poses[k]) continue;
    number_of_key[k] = static_cast<int>(map.keys.size());
    const KeyPicture& key = tracks.keys[k];
    map.keys.push_back({tracks.times_s[static_cast<std::size_t>(key.picture)],
                        geometry::inverse(*grown.poses[k]), key.grey});
  }
  std::vector<int> number_of_track(tracks.tracks.size(), -1);
  for (std::size_t t = 0; t < tracks.tracks.size(); ++t) {
    if (!grown.places[t]) continue;
    const auto& sightings = grown.sightings[t];
    // The look is that of the middle sighting: the others differ from it least.
    const KeySighting& look = sightings[sightings.size() / 2];
    number_of_track[t] = static_cast<int>(map.points.size());
    map.points.push_back({*grown.places[t], grown.covariances[t],
                          static_cast<int>(sightings.size()),
                          number_of_key[static_cast<std::size_t>(look.key)], look.px});
  }
  for (std::size_t k = 0; k < tracks.keys.size(); ++k)
    for (std::size_t f = 0; f < tracks.keys[k].features.size(); ++f) {
      const int track = tracks.keys[k].track_of_feature[f];
      if (track < 0 || number_of_track[static_cast<std::size_t>(track)] < 0) continue;
      map.descriptors.push_back({number_of_track[static_cast<std::size_t>(track)],
                                 tracks.keys[k].features[f].descriptor});
    }
  return map;
}

/// Puts the origin of the map at its first key picture, with its axes.
void to_first_key(LearnedMap& map) {
  const geometry::Pose first_from_map = geometry::inverse(map.keys.front().map_from_camera);
  const Eigen::Matrix3d turn = first_from_map.rotation.toRotationMatrix();
  for (MapPoint& p : map.points) {
    p.place = first_from_map * p.place;
    p.covariance = turn * p.covariance * turn.transpose();
  }
  for (MapKey& k : map.keys) k.map_from_camera = first_from_map * k.map_from_camera;
  for (auto& p : map.path) p.world_from_body = first_from_map * p.world_from_body;
}

}  // namespace

Result<LearnedMap> reconstruct(const FeatureTracks& tracks, const geometry::AnyCamera& camera,
                               const ReconstructOptions& options) {
  MIXRIG_ASSIGN(const Growth grown, grow(tracks, camera, options));
  LearnedMap map = map_of(tracks, grown);
  constexpr std::size_t kFewestPoints = 30;
  if (map.points.size() < kFewestPoints)
    return Error{ErrorCode::kData,
                 fmt::format("only {} places are known from three pictures and more: move the "
                             "camera slowly sideways, and light the room",
                             map.points.size())};
  constexpr double kLeastKnown = 0.25;
  if (static_cast<double>(grown.known) < kLeastKnown * static_cast<double>(grown.followed))
    return Error{ErrorCode::kData,
                 fmt::format("only {} of {} places that were followed have a known depth: the "
                             "camera moves too little for the room's size: move it sideways by a "
                             "tenth of the distance to the walls and more",
                             grown.known, grown.followed)};
  if (2 * map.keys.size() < tracks.keys.size())
    return Error{ErrorCode::kData,
                 fmt::format("only {} of {} key pictures fit together: does the room stand still, "
                             "and is the camera calibrated?",
                             map.keys.size(), tracks.keys.size())};
  map.path = path_of(tracks, camera, grown);
  to_first_key(map);
  if (const double extent = extent_of(map.path); extent > 0) rescale(map, 1 / extent);
  return map;
}

}  // namespace mixrig::reconstruction

// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/growth/reconstruct.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "extras/map/reconstruction/growth/survey.h"

namespace mixrig::reconstruction {
namespace {

/// The sighting of a track in the middle one of the key pictures that show it, or in any.
struct Look {
  int key = -1;
  Eigen::Vector2d px;
  int views = 0;
};

Look look_of(const FeatureTrack& track, const std::vector<int>& key_of_picture) {
  std::vector<Look> looks;
  for (const Sighting& s : track.seen)
    if (const int key = key_of_picture[static_cast<std::size_t>(s.picture)]; key >= 0)
      looks.push_back({key, s.px});
  if (looks.empty()) return {};
  // The others differ from it least.
  Look look = looks[looks.size() / 2];
  look.views = static_cast<int>(looks.size());
  return look;
}

void add_keys(const FeatureTracks& tracks, const Survey& survey, LearnedMap& map,
              std::vector<int>& key_of_picture) {
  for (const KeyPicture& key : tracks.keys) {
    const auto picture = static_cast<std::size_t>(key.picture);
    if (!survey.poses[picture]) continue;
    key_of_picture[picture] = static_cast<int>(map.keys.size());
    map.keys.push_back(
        {tracks.times_s[picture], geometry::inverse(*survey.poses[picture]), key.grey});
  }
}

/// Places with their look, descriptors and the poses of key pictures.
LearnedMap map_of(const FeatureTracks& tracks, const Growth& grown, const Survey& survey) {
  LearnedMap map;
  map.pictures = static_cast<int>(tracks.times_s.size());
  map.residual_px = survey.residual_px;
  map.scale = survey.scale;
  std::vector<int> key_of_picture(tracks.times_s.size(), -1);
  add_keys(tracks, survey, map, key_of_picture);
  std::vector<int> point_of_track(tracks.tracks.size(), -1);
  for (std::size_t t = 0; t < tracks.tracks.size(); ++t) {
    if (!survey.places[t]) continue;
    const Look look = look_of(survey.tracks[t], key_of_picture);
    if (look.key < 0) continue;
    point_of_track[t] = static_cast<int>(map.points.size());
    map.points.push_back({*survey.places[t], survey.covariances[t], look.views, look.key, look.px});
  }
  for (const KeyPicture& key : tracks.keys)
    for (std::size_t f = 0; f < key.features.size(); ++f) {
      const int track = key.track_of_feature[f];
      if (track < 0) continue;
      const int point =
          point_of_track[static_cast<std::size_t>(grown.same_as[static_cast<std::size_t>(track)])];
      if (point >= 0) map.descriptors.push_back({point, key.features[f].descriptor});
    }
  for (std::size_t i = 0; i < survey.poses.size(); ++i)
    if (survey.poses[i])
      map.path.push_back({tracks.times_s[i], geometry::inverse(*survey.poses[i])});
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
                               const ReconstructOptions& options, const DepthRecord* depth) {
  MIXRIG_ASSIGN(const Growth grown, grow(tracks, camera, options));
  const Survey surveyed = survey(tracks, camera, grown, options, depth);
  LearnedMap map = map_of(tracks, grown, surveyed);
  constexpr std::size_t kFewestPoints = 30;
  if (map.points.size() < kFewestPoints)
    return Error{ErrorCode::kData,
                 fmt::format("only {} places are known from three pictures and more: move the "
                             "camera slowly sideways, and light the room",
                             map.points.size())};
  constexpr double kLeastKnown = 0.25;
  if (static_cast<double>(surveyed.known) < kLeastKnown * static_cast<double>(surveyed.followed))
    return Error{ErrorCode::kData,
                 fmt::format("only {} of {} places that were followed have a known depth: the "
                             "camera moves too little for the room's size: move it sideways by a "
                             "tenth of the distance to the walls and more",
                             surveyed.known, surveyed.followed)};
  if (2 * map.keys.size() < tracks.keys.size())
    return Error{ErrorCode::kData,
                 fmt::format("only {} of {} key pictures fit together: does the room stand still, "
                             "and is the camera calibrated?",
                             map.keys.size(), tracks.keys.size())};
  to_first_key(map);
  const double extent = extent_of(map.path);
  if (!map.scale && extent > 0) rescale(map, 1 / extent);
  return map;
}

}  // namespace mixrig::reconstruction

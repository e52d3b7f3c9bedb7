// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/growth/survey.h"

#include <algorithm>

#include "extras/map/reconstruction/growth/surveyor.h"
#include "extras/map/reconstruction/views/rays.h"
#include "extras/map/reconstruction/views/resection.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr std::size_t kMostViews = 200;

}  // namespace

Surveyor::Surveyor(const FeatureTracks& tracks, const geometry::AnyCamera& camera,
                   const Growth& grown, const ReconstructOptions& options, const DepthRecord* depth)
    : tracks_(tracks), camera_(camera), grown_(grown), options_(options), depth_(depth) {
  result_.poses.resize(tracks.times_s.size());
  result_.places = grown.places;
  result_.covariances = grown.covariances;
  for (std::size_t k = 0; k < tracks.keys.size(); ++k)
    result_.poses[static_cast<std::size_t>(tracks.keys[k].picture)] = grown.poses[k];
  gather();
}

/// Collects the sightings that remain in key pictures, and all in the pictures between them.
void Surveyor::gather() {
  std::vector<char> is_key(tracks_.times_s.size(), 0);
  for (const KeyPicture& key : tracks_.keys) is_key[static_cast<std::size_t>(key.picture)] = 1;
  result_.tracks.resize(tracks_.tracks.size());
  for (std::size_t t = 0; t < tracks_.tracks.size(); ++t) {
    const auto& old = tracks_.tracks[t].seen;
    for (const KeySighting& s : grown_.sightings[t])
      result_.tracks[t].seen.push_back({tracks_.keys[static_cast<std::size_t>(s.key)].picture, s.px,
                                        old.empty() ? 1 : old.front().sigma_px});
    auto& seen = result_.tracks[static_cast<std::size_t>(grown_.same_as[t])].seen;
    for (const Sighting& s : old)
      if (is_key[number(s)] == 0) seen.push_back(s);
  }
  for (FeatureTrack& track : result_.tracks) {
    const auto earlier = [](const Sighting& a, const Sighting& b) { return a.picture < b.picture; };
    const auto same = [](const Sighting& a, const Sighting& b) { return a.picture == b.picture; };
    std::stable_sort(track.seen.begin(), track.seen.end(), earlier);
    track.seen.erase(std::unique(track.seen.begin(), track.seen.end(), same), track.seen.end());
  }
}

/// Finds poses from the places: of pictures without a pose, or with `all` of all but the views.
void Surveyor::place_pictures(bool all) {
  std::vector<std::vector<Vector3d>> places(result_.poses.size());
  std::vector<std::vector<estimation::Bearing>> rays(result_.poses.size());
  for (std::size_t t = 0; t < result_.tracks.size(); ++t) {
    if (!result_.places[t]) continue;
    for (const Sighting& s : result_.tracks[t].seen) {
      if (all ? has_view(s) : result_.poses[number(s)].has_value()) continue;
      const auto ray = ray_of(camera_, s.px, s.sigma_px * result_.sigma_scale);
      if (ray) places[number(s)].push_back(*result_.places[t]), rays[number(s)].push_back(*ray);
    }
  }
  std::optional<Pose> before;
  for (std::size_t i = 0; i < result_.poses.size(); ++i) {
    constexpr std::size_t kFewestSeen = 20;
    const auto agrees = [&](const std::optional<Resection>& r) {
      return r && r->inliers.size() >= kFewestSeen && 2 * r->inliers.size() >= places[i].size();
    };
    if (!places[i].empty()) {
      std::optional<Resection> found;
      const auto start = result_.poses[i] ? result_.poses[i] : before;
      if (start) found = refine_pose(places[i], rays[i], *start);
      if (!agrees(found)) found = find_pose(places[i], rays[i]);
      result_.poses[i].reset();
      if (agrees(found)) result_.poses[i] = found->camera_from_map;
    }
    if (result_.poses[i]) before = result_.poses[i];
  }
}

/// Chooses the views: key pictures, and others, evenly, up to kMostViews.
void Surveyor::choose_views() {
  is_view_.assign(result_.poses.size(), 0);
  std::size_t views = 0;
  for (const KeyPicture& key : tracks_.keys) {
    const auto i = static_cast<std::size_t>(key.picture);
    if (result_.poses[i]) is_view_[i] = 1, ++views;
  }
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < result_.poses.size(); ++i)
    if (result_.poses[i] && is_view_[i] == 0) others.push_back(i);
  const std::size_t most = views < kMostViews ? std::min(kMostViews - views, others.size()) : 0;
  for (std::size_t k = 0; k < most; ++k) is_view_[others[k * others.size() / most]] = 1;
}

Survey Surveyor::run() {
  Crew crew(options_.threads);
  place_pictures(false);
  choose_views();
  constexpr int kRounds = 3, kIterations = 20;
  for (int round = 0; round < kRounds; ++round) {
    if (round < 2) align(crew);
    make_rays();
    if (round == 0) set_sigma();
    triangulate();
    adjust(kIterations);
    set_sigma();
    drop_outliers();
    adjust(kIterations);
    set_sigma();
  }
  constexpr int kDepthRounds = 2;
  for (int round = 0; round < kDepthRounds && measure(); ++round) {
    adjust(kIterations);
    drop_outliers();
  }
  triangulate();
  drop_outliers();
  finish();
  place_pictures(true);
  return std::move(result_);
}

Survey survey(const FeatureTracks& tracks, const geometry::AnyCamera& camera, const Growth& grown,
              const ReconstructOptions& options, const DepthRecord* depth) {
  return Surveyor(tracks, camera, grown, options, depth).run();
}

}  // namespace mixrig::reconstruction

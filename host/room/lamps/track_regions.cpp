// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/track_regions.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "hal/base/angles.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector3d;

constexpr double kNearest_m = 1, kGate_rad = 1 * kDeg, kMostGate_rad = 12 * kDeg;
constexpr double kSizeFactor = 4;
constexpr double kNoMatch = 1e9;

struct Track {
  std::vector<Sighting> seen;
  Vector3d eye_m, ray;  ///< of the last sighting, world
  double solid_angle_sr = 0;
  bool cut = false;
};

/// Cost of a region as the track's next sighting: 0 where it is so without doubt, kNoMatch where it
/// cannot be.
double cost(const Track& track, const BrightRegion& region, const geometry::Pose& pose) {
  const double radius = std::sqrt(std::max(region.solid_angle_sr, track.solid_angle_sr) / kPi);
  const double moved_m = (pose.translation_m - track.eye_m).norm();
  const double gate = std::min(kMostGate_rad, kGate_rad + 0.3 * radius + moved_m / kNearest_m);
  const Vector3d ray = pose.rotation * region.direction;
  const double off = std::atan2(ray.cross(track.ray).norm(), ray.dot(track.ray));
  const double larger = std::abs(std::log(region.solid_angle_sr / track.solid_angle_sr));
  const double most = std::log(kSizeFactor) * (region.cut || track.cut ? 2 : 1);
  if (off > gate || larger > most) return kNoMatch;
  return off / gate + larger / most;
}

void go_on(Track& track, const LampView& view, Sighting at) {
  const BrightRegion& region = view.regions[static_cast<std::size_t>(at.region)];
  track.seen.push_back(at);
  track.eye_m = view.world_from_camera.translation_m;
  track.ray = view.world_from_camera.rotation * region.direction;
  track.solid_angle_sr = region.solid_angle_sr, track.cut = region.cut;
}

struct Pair {
  double cost;
  std::size_t track, region;
};

}  // namespace

std::vector<std::vector<Sighting>> track_regions(std::span<const LampView> views) {
  std::vector<Track> tracks;
  std::vector<Pair> pairs;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const LampView& view = views[v];
    pairs.clear();
    for (std::size_t t = 0; t < tracks.size(); ++t)
      for (std::size_t r = 0; r < view.regions.size(); ++r) {
        const double c = cost(tracks[t], view.regions[r], view.world_from_camera);
        if (c < kNoMatch) pairs.push_back({c, t, r});
      }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      return std::tie(a.cost, a.track, a.region) < std::tie(b.cost, b.track, b.region);
    });
    std::vector<bool> track_done(tracks.size()), region_done(view.regions.size());
    for (const Pair& p : pairs) {
      if (track_done[p.track] || region_done[p.region]) continue;
      track_done[p.track] = region_done[p.region] = true;
      go_on(tracks[p.track], view, {static_cast<int>(v), static_cast<int>(p.region)});
    }
    for (std::size_t r = 0; r < view.regions.size(); ++r) {
      if (region_done[r]) continue;
      tracks.emplace_back();
      go_on(tracks.back(), view, {static_cast<int>(v), static_cast<int>(r)});
    }
  }
  std::vector<std::vector<Sighting>> seen;
  for (Track& track : tracks) seen.push_back(std::move(track.seen));
  return seen;
}

}  // namespace mixrig::lights

// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/growth/loops.h"

#include <algorithm>
#include <map>

namespace mixrig::reconstruction {
namespace {

constexpr double kRadius_px = 12, kFeatureSigma_px = 0.6;
constexpr int kMostDistance = 250 * 250;
constexpr double kRatio = 0.8;  ///< of distances to the best and the next feature, not squared

/// Features of a key picture by cells of the search radius.
class Grid {
 public:
  explicit Grid(const KeyPicture& key) : key_(key) {
    for (std::size_t f = 0; f < key.features.size(); ++f)
      cells_[cell(key.features[f].px)].push_back(static_cast<int>(f));
  }
  /// The feature near `px` that looks like one of `looks`; -1 where none does, or two do.
  int find(const Eigen::Vector2d& px, const std::vector<const Descriptor*>& looks) const {
    int best = -1, least = kMostDistance, next = kMostDistance;
    const auto [cx, cy] = cell(px);
    for (int y = cy - 1; y <= cy + 1; ++y)
      for (int x = cx - 1; x <= cx + 1; ++x) {
        const auto at = cells_.find({x, y});
        if (at == cells_.end()) continue;
        for (const int f : at->second) {
          const Feature& feature = key_.features[static_cast<std::size_t>(f)];
          if ((feature.px - px).norm() > kRadius_px) continue;
          int distance = kMostDistance;
          for (const Descriptor* look : looks)
            distance = std::min(distance, distance_of(*look, feature.descriptor));
          if (distance < least)
            next = least, least = distance, best = f;
          else
            next = std::min(next, distance);
        }
      }
    return least < kRatio * kRatio * next ? best : -1;
  }

 private:
  static std::pair<int, int> cell(const Eigen::Vector2d& px) {
    return {static_cast<int>(px.x() / kRadius_px), static_cast<int>(px.y() / kRadius_px)};
  }
  const KeyPicture& key_;
  std::map<std::pair<int, int>, std::vector<int>> cells_;
};

bool sees(const Growth& grown, std::size_t track, int key) {
  const auto& seen = grown.sightings[track];
  return std::any_of(seen.begin(), seen.end(),
                     [key](const KeySighting& s) { return s.key == key; });
}

/// Moves what `other` has to `track` where both have no key picture in common.
bool unite(Growth& grown, std::size_t track, std::size_t other) {
  for (const KeySighting& s : grown.sightings[other])
    if (sees(grown, track, s.key)) return false;
  auto& seen = grown.sightings[track];
  seen.insert(seen.end(), grown.sightings[other].begin(), grown.sightings[other].end());
  std::sort(seen.begin(), seen.end(),
            [](const KeySighting& a, const KeySighting& b) { return a.key < b.key; });
  grown.sightings[other].clear();
  grown.places[other].reset();
  for (int& same : grown.same_as)
    if (same == static_cast<int>(other)) same = static_cast<int>(track);
  return true;
}

}  // namespace

int distance_of(const Descriptor& a, const Descriptor& b) {
  int sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const int d = static_cast<int>(a[i]) - static_cast<int>(b[i]);
    sum += d * d;
  }
  return sum;
}

int join_loops(const FeatureTracks& tracks, const geometry::AnyCamera& camera, Growth& grown) {
  std::vector<std::vector<const Descriptor*>> looks(tracks.tracks.size());
  for (const KeyPicture& key : tracks.keys)
    for (std::size_t f = 0; f < key.features.size(); ++f)
      if (key.track_of_feature[f] >= 0)
        looks[static_cast<std::size_t>(key.track_of_feature[f])].push_back(
            &key.features[f].descriptor);
  const Size size = geometry::size_px(camera);
  int found = 0;
  for (std::size_t k = 0; k < tracks.keys.size(); ++k) {
    if (!grown.poses[k]) continue;
    const Grid grid(tracks.keys[k]);
    for (std::size_t t = 0; t < grown.places.size(); ++t) {
      if (!grown.places[t] || looks[t].empty() || sees(grown, t, static_cast<int>(k))) continue;
      const auto px = geometry::project(camera, *grown.poses[k] * *grown.places[t]);
      if (!px || px->x() < 0 || px->y() < 0 || px->x() >= size.width || px->y() >= size.height)
        continue;
      const int f = grid.find(*px, looks[t]);
      if (f < 0) continue;
      const auto feature = static_cast<std::size_t>(f);
      const int other = tracks.keys[k].track_of_feature[feature];
      if (other >= 0 && !grown.sightings[static_cast<std::size_t>(other)].empty()) {
        found += unite(grown, t, static_cast<std::size_t>(other)) ? 1 : 0;
      } else if (const auto ray =
                     ray_of(camera, tracks.keys[k].features[feature].px, kFeatureSigma_px)) {
        grown.sightings[t].push_back(
            {static_cast<int>(k), tracks.keys[k].features[feature].px, *ray});
        std::sort(grown.sightings[t].begin(), grown.sightings[t].end(),
                  [](const KeySighting& a, const KeySighting& b) { return a.key < b.key; });
        ++found;
      }
    }
  }
  return found;
}

}  // namespace mixrig::reconstruction

// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/growth/growth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "extras/map/reconstruction/growth/loops.h"
#include "extras/map/reconstruction/views/two_view.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/estimation/points/triangulation.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr double kOutlierSigmas = 5;
constexpr int kLocalKeys = 8;
constexpr std::size_t kFewestPlaces = 25, kFewestOfPlaces = 3;  ///< and a third

class Grower {
 public:
  Grower(const FeatureTracks& tracks, const geometry::AnyCamera& camera,
         const ReconstructOptions& options)
      : tracks_(tracks), camera_(camera), options_(options) {
    grown_.poses.resize(tracks.keys.size());
    grown_.places.resize(tracks.tracks.size());
    grown_.covariances.resize(tracks.tracks.size());
    grown_.sightings.resize(tracks.tracks.size());
    grown_.same_as.resize(tracks.tracks.size());
    std::iota(grown_.same_as.begin(), grown_.same_as.end(), 0);
    std::map<int, int> key_of_picture;
    for (std::size_t k = 0; k < tracks.keys.size(); ++k)
      key_of_picture[tracks.keys[k].picture] = static_cast<int>(k);
    for (std::size_t t = 0; t < tracks.tracks.size(); ++t)
      for (const Sighting& s : tracks.tracks[t].seen) {
        const auto key = key_of_picture.find(s.picture);
        if (key == key_of_picture.end()) continue;
        if (const auto ray = ray_of(camera, s.px, s.sigma_px))
          grown_.sightings[t].push_back({key->second, s.px, *ray});
      }
  }

  Result<Growth> grow();

 private:
  struct Relation {
    int a, b;
    TwoViews views;
  };
  std::vector<RayPair> pairs_of(int a, int b) const;
  std::vector<Relation> relations() const;
  Result<std::pair<int, int>> start();
  bool begin_with(int b);
  bool add(int key);
  void triangulate(bool all);
  void adjust_some(const std::set<int>& moving, int iterations);
  void adjust_near(int key);
  void adjust_all(int iterations);
  void drop_outliers();
  void finish();
  double residual_of(std::size_t track, const KeySighting& s) const;
  const KeySighting* sighting(std::size_t track, int key) const;

  const FeatureTracks& tracks_;
  const geometry::AnyCamera& camera_;
  const ReconstructOptions& options_;
  Growth grown_;
};

const KeySighting* Grower::sighting(std::size_t track, int key) const {
  for (const KeySighting& s : grown_.sightings[track])
    if (s.key == key) return &s;
  return nullptr;
}

/// Error of a sighting in sigmas; large where the place lies behind the camera.
double Grower::residual_of(std::size_t track, const KeySighting& s) const {
  const Vector3d p = *grown_.poses[static_cast<std::size_t>(s.key)] * *grown_.places[track];
  if (!(p.dot(s.ray.direction) > 0)) return 1e9;
  return ray_error<double>(s.ray, p).norm();
}

/// Rays of the tracks that both key pictures show.
std::vector<RayPair> Grower::pairs_of(int a, int b) const {
  std::vector<RayPair> pairs;
  for (std::size_t t = 0; t < grown_.sightings.size(); ++t) {
    const KeySighting *in_a = sighting(t, a), *in_b = sighting(t, b);
    if (in_a != nullptr && in_b != nullptr) pairs.push_back({in_a->ray, in_b->ray});
  }
  return pairs;
}

/// Pairs of key pictures, those first that show most places move.
std::vector<Grower::Relation> Grower::relations() const {
  const int keys = static_cast<int>(tracks_.keys.size());
  constexpr int kFirsts = 4;
  constexpr std::size_t kFewestPairs = 60;
  std::vector<Relation> all;
  for (int f = 0; f < kFirsts; ++f)
    for (int a = f * keys / kFirsts, b = a + 1; b < keys; ++b) {
      const std::vector<RayPair> pairs = pairs_of(a, b);
      if (pairs.size() < kFewestPairs) break;
      if (const auto views = relate_views(pairs)) all.push_back({a, b, *views});
    }
  // By the number of places that turning alone does not explain.
  const auto moving = [](const Relation& r) {
    return (1 - r.views.turned_share) * static_cast<double>(r.views.inliers.size());
  };
  std::sort(all.begin(), all.end(),
            [&](const Relation& x, const Relation& y) { return moving(x) > moving(y); });
  return all;
}

/// The two key pictures to begin with.
Result<std::pair<int, int>> Grower::start() {
  const std::vector<Relation> all = relations();
  if (all.empty())
    return Error{ErrorCode::kData,
                 "too few places of the room can be followed from picture to picture: move the "
                 "camera slower, and light the room"};
  constexpr std::size_t kTries = 5;
  for (std::size_t i = 0; i < std::min(all.size(), kTries); ++i) {
    const Relation& r = all[i];
    if (r.views.turned_share > options_.most_turned_share) continue;
    grown_.poses[static_cast<std::size_t>(r.a)] = Pose{};
    grown_.poses[static_cast<std::size_t>(r.b)] = r.views.b_from_a;
    if (begin_with(r.b)) return std::pair(r.a, r.b);
    grown_.poses[static_cast<std::size_t>(r.a)].reset();
    grown_.poses[static_cast<std::size_t>(r.b)].reset();
    for (auto& place : grown_.places) place.reset();
  }
  return Error{
      ErrorCode::kData,
      fmt::format("the camera turns, but hardly moves: of no two pictures turning alone explains "
                  "fewer than {:.0f} % of the places, and beside it they shift by {:.2f} deg: move "
                  "it sideways",
                  100 * all.front().views.turned_share,
                  all.front().views.parallax_rad * 180 / std::numbers::pi)};
}

bool Grower::begin_with(int b) {
  triangulate(false);
  adjust_some({b}, 30);
  drop_outliers();
  std::size_t known = 0;
  for (const auto& place : grown_.places) known += place.has_value() ? 1 : 0;
  return known >= 2 * kFewestPlaces;
}

/// The pose of a key picture from known places; false where they do not agree.
bool Grower::add(int key) {
  std::vector<Vector3d> places;
  std::vector<estimation::Bearing> rays;
  for (std::size_t t = 0; t < grown_.places.size(); ++t) {
    if (!grown_.places[t]) continue;
    if (const KeySighting* s = sighting(t, key))
      places.push_back(*grown_.places[t]), rays.push_back(s->ray);
  }
  if (places.size() < kFewestPlaces) return false;
  const auto pose = find_pose(places, rays);
  if (!pose || pose->inliers.size() < kFewestPlaces ||
      kFewestOfPlaces * pose->inliers.size() < places.size())
    return false;
  grown_.poses[static_cast<std::size_t>(key)] = pose->camera_from_map;
  return true;
}

/// Triangulates places that are not known yet, or all, from the key pictures that have poses.
void Grower::triangulate(bool all) {
  for (std::size_t t = 0; t < grown_.sightings.size(); ++t) {
    if (grown_.places[t] && !all) continue;
    std::vector<estimation::PointView> views;
    for (const KeySighting& s : grown_.sightings[t])
      if (grown_.poses[static_cast<std::size_t>(s.key)])
        views.push_back({geometry::inverse(*grown_.poses[static_cast<std::size_t>(s.key)]), s.ray});
    grown_.places[t].reset();
    if (views.size() < 2) continue;
    double widest = 0;
    const Vector3d first =
        views.front().world_from_camera.rotation * views.front().bearing.direction;
    for (const auto& v : views)
      widest =
          std::max(widest, first.cross(v.world_from_camera.rotation * v.bearing.direction).norm());
    if (widest < options_.least_angle_rad) continue;
    const auto place = estimation::triangulate(views);
    if (!place.usable()) continue;
    grown_.places[t] = place.value;
    grown_.covariances[t] = place.covariance;
  }
}

/// Moves the poses of `moving` and every place that they see.
void Grower::adjust_some(const std::set<int>& moving, int iterations) {
  Bundle bundle;
  std::vector<int> view_of_key(tracks_.keys.size(), -1), key_of_view;
  std::vector<std::size_t> track_of_place;
  for (std::size_t t = 0; t < grown_.places.size(); ++t) {
    if (!grown_.places[t]) continue;
    const auto& seen = grown_.sightings[t];
    if (std::none_of(seen.begin(), seen.end(),
                     [&](const KeySighting& s) { return moving.count(s.key) > 0; }))
      continue;
    for (const KeySighting& s : seen) {
      const auto& pose = grown_.poses[static_cast<std::size_t>(s.key)];
      if (!pose) continue;
      int& view = view_of_key[static_cast<std::size_t>(s.key)];
      if (view < 0) {
        view = static_cast<int>(bundle.camera_from_map.size());
        bundle.camera_from_map.push_back(*pose);
        bundle.fixed.push_back(moving.count(s.key) == 0);
        key_of_view.push_back(s.key);
      }
      bundle.rays.push_back({view, static_cast<int>(bundle.places.size()), s.ray});
    }
    bundle.places.push_back(*grown_.places[t]);
    track_of_place.push_back(t);
  }
  if (bundle.rays.empty() || !adjust(bundle, iterations, options_.threads)) return;
  for (std::size_t v = 0; v < key_of_view.size(); ++v)
    grown_.poses[static_cast<std::size_t>(key_of_view[v])] = bundle.camera_from_map[v];
  for (std::size_t p = 0; p < track_of_place.size(); ++p)
    grown_.places[track_of_place[p]] = bundle.places[p];
}

void Grower::adjust_near(int key) {
  std::vector<int> solved;
  for (std::size_t k = 0; k < grown_.poses.size(); ++k)
    if (grown_.poses[k]) solved.push_back(static_cast<int>(k));
  std::sort(solved.begin(), solved.end(),
            [key](int a, int b) { return std::abs(a - key) < std::abs(b - key); });
  // The first solved pictures hold the scale: two stay.
  const std::size_t most = solved.size() > 2 ? solved.size() - 2 : 1;
  solved.resize(std::min<std::size_t>(kLocalKeys, most));
  adjust_some({solved.begin(), solved.end()}, 10);
}

void Grower::adjust_all(int iterations) {
  std::set<int> moving;
  for (std::size_t k = 0; k < grown_.poses.size(); ++k)
    if (grown_.poses[k]) moving.insert(static_cast<int>(k));
  moving.erase(moving.begin());
  adjust_some(moving, iterations);
}

/// Takes out sightings that lie off, and places that lose too many of them.
void Grower::drop_outliers() {
  for (std::size_t t = 0; t < grown_.places.size(); ++t) {
    if (!grown_.places[t]) continue;
    auto& seen = grown_.sightings[t];
    const auto off = [&](const KeySighting& s) {
      return grown_.poses[static_cast<std::size_t>(s.key)] && residual_of(t, s) > kOutlierSigmas;
    };
    const auto before = seen.size();
    const auto bad = static_cast<std::size_t>(std::count_if(seen.begin(), seen.end(), off));
    if (bad == 0) continue;
    if (3 * bad > before) {
      grown_.places[t].reset();  // it moves, or is no place at all
      continue;
    }
    seen.erase(std::remove_if(seen.begin(), seen.end(), off), seen.end());
  }
}

/// Covariances at the last poses; leaves out what is not well known.
void Grower::finish() {
  triangulate(true);
  double squares = 0, count = 0;
  for (std::size_t t = 0; t < grown_.places.size(); ++t) {
    auto& seen = grown_.sightings[t];
    seen.erase(std::remove_if(seen.begin(), seen.end(),
                              [&](const KeySighting& s) {
                                return !grown_.poses[static_cast<std::size_t>(s.key)];
                              }),
               seen.end());
    if (static_cast<int>(seen.size()) >= options_.least_views) ++grown_.followed;
    if (!grown_.places[t]) continue;
    double distance = 0;
    for (const KeySighting& s : seen)
      distance += (*grown_.poses[static_cast<std::size_t>(s.key)] * *grown_.places[t]).norm() /
                  static_cast<double>(seen.size());
    const double worst = estimation::spectrum_of(grown_.covariances[t]).values[2];
    if (static_cast<int>(seen.size()) < options_.least_views ||
        !(std::sqrt(worst) < options_.most_sigma_share * distance)) {
      grown_.places[t].reset();
      continue;
    }
    ++grown_.known;
    for (const KeySighting& s : seen) {
      const double sigma_px = tracks_.tracks[t].seen.front().sigma_px;
      const double off_px = residual_of(t, s) * sigma_px;
      squares += off_px * off_px, count += 2;
    }
  }
  grown_.residual_px = count > 0 ? std::sqrt(squares / count) : 0;
}

Result<Growth> Grower::grow() {
  if (tracks_.keys.size() < 3)
    return Error{ErrorCode::kData, "fewer than three pictures differ: move the camera"};
  MIXRIG_ASSIGN(const auto begun, start());
  std::vector<int> order;
  const int keys = static_cast<int>(tracks_.keys.size());
  for (int k = begun.first + 1; k < begun.second; ++k) order.push_back(k);
  for (int k = begun.second + 1; k < keys; ++k) order.push_back(k);
  for (int k = begun.first - 1; k >= 0; --k) order.push_back(k);
  constexpr int kGlobalEvery = 10;
  for (int round = 0, added = 0; round < 2; ++round)
    for (const int k : order) {
      if (grown_.poses[static_cast<std::size_t>(k)] || !add(k)) continue;
      triangulate(false);
      if (++added % kGlobalEvery == 0)
        adjust_all(10);
      else
        adjust_near(k);
      drop_outliers();
    }
  constexpr int kRounds = 3, kIterations = 40;
  for (int round = 0; round < kRounds; ++round) {
    adjust_all(kIterations);
    drop_outliers();
    if (round == 0) join_loops(tracks_, camera_, grown_);
    triangulate(false);
  }
  adjust_all(kIterations);
  finish();
  return std::move(grown_);
}

}  // namespace

Result<Growth> grow(const FeatureTracks& tracks, const geometry::AnyCamera& camera,
                    const ReconstructOptions& options) {
  return Grower(tracks, camera, options).grow();
}

}  // namespace mixrig::reconstruction

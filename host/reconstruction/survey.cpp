// SPDX-License-Identifier: Apache-2.0
#include "host/reconstruction/survey.h"

#include <algorithm>
#include <cmath>

#include "hal/base/order_statistics.h"
#include "hal/base/parallel.h"
#include "host/estimation/decompositions.h"
#include "host/estimation/points/triangulation.h"
#include "host/reconstruction/bundle.h"
#include "host/reconstruction/rays.h"
#include "host/reconstruction/resection.h"
#include "host/reconstruction/track_align.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr std::size_t kMostViews = 200;
constexpr double kSurveyOutlierSigmas = 4;
constexpr double kRangeSigma = 0.01;

/// A sighting in a picture that is adjusted.
struct SurveyRay {
  std::size_t seen;  ///< number in the track
  estimation::Bearing ray;
};

class Surveyor {
 public:
  Surveyor(const FeatureTracks& tracks, const geometry::AnyCamera& camera, const Growth& grown,
           const ReconstructOptions& options, const DepthRecord* depth);
  Survey run();

 private:
  void gather();
  void place_pictures(bool all);
  void choose_views();
  void align(Crew& crew);
  void align_track(FeatureTrack& track, const std::optional<Vector3d>& place) const;
  std::optional<Eigen::Matrix2d> turned(const Sighting& from, const Sighting& to,
                                        const std::optional<Vector3d>& place) const;
  void make_rays();
  void triangulate();
  void adjust(int iterations);
  void set_sigma();
  void drop_outliers();
  bool measure();
  void rescale_to_metres(double metres_per_unit);
  void finish();
  const Pose& pose(const Sighting& s) const { return *result_.poses[number(s)]; }
  bool has_view(const Sighting& s) const { return is_view_[number(s)] != 0; }
  static std::size_t number(const Sighting& s) { return static_cast<std::size_t>(s.picture); }
  double error_of(std::size_t track, const SurveyRay& r) const;

  const FeatureTracks& tracks_;
  const geometry::AnyCamera& camera_;
  const Growth& grown_;
  const ReconstructOptions& options_;
  const DepthRecord* depth_;
  Survey result_;
  std::vector<char> is_view_;                 ///< by picture
  std::vector<std::vector<SurveyRay>> rays_;  ///< by track, of views
  std::vector<double> measured_;              ///< by track, relative to its distance; 0 not
};

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

/// Sightings of the key pictures as they were left, and all between them.
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

/// Poses from the places; of pictures without one, or of all but the views.
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

/// Key pictures, and so many of the others.
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

/// Pixels at `to` per pixel at `from`, on a plane across the view through the place; where that is
/// not known, far away.
std::optional<Eigen::Matrix2d> Surveyor::turned(const Sighting& from, const Sighting& to,
                                                const std::optional<Vector3d>& place) const {
  constexpr double kFar = 1e6;
  const auto middle = geometry::unproject(camera_, from.px);
  if (!middle) return std::nullopt;
  const double depth = place ? (pose(from) * *place).norm() : kFar;
  const Pose to_from = pose(to) * geometry::inverse(pose(from));
  const auto seen = [&](double u, double v) -> std::optional<Eigen::Vector2d> {
    const auto ray = geometry::unproject(camera_, from.px + Eigen::Vector2d(u, v));
    if (!ray) return std::nullopt;
    return geometry::project(camera_, to_from * Vector3d(depth / ray->dot(*middle) * *ray));
  };
  const auto left = seen(-2, 0), right = seen(2, 0), up = seen(0, -2), down = seen(0, 2);
  if (!left || !right || !up || !down) return std::nullopt;
  Eigen::Matrix2d out;
  out << (*right - *left) / 4, (*down - *up) / 4;
  return out;
}

void Surveyor::align_track(FeatureTrack& track, const std::optional<Vector3d>& place) const {
  std::vector<Sighting> there;
  for (const Sighting& s : track.seen)
    if (result_.poses[number(s)]) there.push_back(s);
  if (there.size() < 2) return;
  const std::size_t reference = there.size() / 2;
  std::vector<TrackLook> looks;
  std::vector<std::size_t> of_look;
  std::size_t middle = 0;
  for (std::size_t i = 0; i < there.size(); ++i) {
    const Image<std::uint8_t>& grey = tracks_.greys[number(there[i])];
    const auto turn = turned(there[reference], there[i], place);
    if (grey.size() != geometry::size_px(camera_) || !turn) continue;
    if (i == reference) middle = looks.size() + 1;
    looks.push_back({&grey, there[i].px, *turn, 0}), of_look.push_back(i);
  }
  if (middle == 0 || !align_looks(looks, middle - 1)) return;
  track.seen.clear();
  for (std::size_t k = 0; k < looks.size(); ++k)
    if (looks[k].sigma_px > 0)
      track.seen.push_back({there[of_look[k]].picture, looks[k].px, looks[k].sigma_px});
}

void Surveyor::align(Crew& crew) {
  if (tracks_.greys.size() != result_.poses.size()) return;
  crew.rows(static_cast<int>(result_.tracks.size()), 16, [&](int begin, int end) {
    for (int t = begin; t < end; ++t) {
      const auto i = static_cast<std::size_t>(t);
      align_track(result_.tracks[i], result_.places[i]);
    }
  });
}

void Surveyor::make_rays() {
  rays_.assign(result_.tracks.size(), {});
  for (std::size_t t = 0; t < result_.tracks.size(); ++t)
    for (std::size_t i = 0; i < result_.tracks[t].seen.size(); ++i) {
      const Sighting& s = result_.tracks[t].seen[i];
      if (!has_view(s)) continue;
      if (const auto ray = ray_of(camera_, s.px, s.sigma_px * result_.sigma_scale))
        rays_[t].push_back({i, *ray});
    }
}

void Surveyor::triangulate() {
  for (std::size_t t = 0; t < rays_.size(); ++t) {
    std::vector<estimation::PointView> views;
    for (const SurveyRay& r : rays_[t])
      views.push_back({geometry::inverse(pose(result_.tracks[t].seen[r.seen])), r.ray});
    result_.places[t].reset();
    if (static_cast<int>(views.size()) < options_.least_views) continue;
    const auto place = estimation::triangulate(views);
    if (!place.usable()) continue;
    result_.places[t] = place.value;
    result_.covariances[t] = place.covariance;
  }
}

void Surveyor::adjust(int iterations) {
  Bundle bundle;
  std::vector<int> view_of(result_.poses.size(), -1);
  std::vector<std::size_t> picture_of_view, track_of_place;
  for (std::size_t i = 0; i < view_of.size(); ++i) {
    if (is_view_[i] == 0) continue;
    view_of[i] = static_cast<int>(picture_of_view.size());
    bundle.camera_from_map.push_back(*result_.poses[i]);
    bundle.fixed.push_back(picture_of_view.empty());
    picture_of_view.push_back(i);
  }
  for (std::size_t t = 0; t < rays_.size(); ++t) {
    if (!result_.places[t]) continue;
    for (const SurveyRay& r : rays_[t])
      bundle.rays.push_back({view_of[number(result_.tracks[t].seen[r.seen])],
                             static_cast<int>(bundle.places.size()), r.ray});
    if (!rays_[t].empty() && !measured_.empty() && measured_[t] > 0) {
      const Sighting& s = result_.tracks[t].seen[rays_[t][rays_[t].size() / 2].seen];
      const double range_m = measured_[t] * (pose(s) * *result_.places[t]).norm();
      bundle.ranges.push_back({view_of[number(s)], static_cast<int>(bundle.places.size()), range_m,
                               kRangeSigma * range_m});
    }
    bundle.places.push_back(*result_.places[t]);
    track_of_place.push_back(t);
  }
  if (bundle.rays.empty() || !reconstruction::adjust(bundle, iterations, options_.threads)) return;
  for (std::size_t v = 0; v < picture_of_view.size(); ++v)
    result_.poses[picture_of_view[v]] = bundle.camera_from_map[v];
  for (std::size_t p = 0; p < track_of_place.size(); ++p)
    result_.places[track_of_place[p]] = bundle.places[p];
}

/// In sigmas; large where the place lies behind.
double Surveyor::error_of(std::size_t track, const SurveyRay& r) const {
  const Vector3d p = pose(result_.tracks[track].seen[r.seen]) * *result_.places[track];
  return p.dot(r.ray.direction) > 0 ? ray_error<double>(r.ray, p).norm() : 1e9;
}

/// Sigmas such that half of the errors lie where half of those of a normal distribution would.
void Surveyor::set_sigma() {
  std::vector<double> errors;
  for (std::size_t t = 0; t < rays_.size(); ++t)
    if (result_.places[t])
      for (const SurveyRay& r : rays_[t]) errors.push_back(error_of(t, r));
  constexpr double kMedianOfTwo = 1.1774;  // of the length of two normal coordinates
  const double factor = median_in_place(std::span<double>(errors)) / kMedianOfTwo;
  if (!(factor > 0)) return;
  result_.sigma_scale *= factor;
  for (auto& rays : rays_)
    for (SurveyRay& r : rays) r.ray.whitener /= factor;
}

/// Takes out sightings that lie off, and places that lose a third of them.
void Surveyor::drop_outliers() {
  for (std::size_t t = 0; t < rays_.size(); ++t) {
    if (!result_.places[t]) continue;
    auto& rays = rays_[t];
    const auto off = [&](const SurveyRay& r) { return error_of(t, r) > kSurveyOutlierSigmas; };
    const auto before = rays.size();
    const auto bad = static_cast<std::size_t>(std::count_if(rays.begin(), rays.end(), off));
    if (3 * bad > before)
      result_.places[t].reset();
    else
      rays.erase(std::remove_if(rays.begin(), rays.end(), off), rays.end());
  }
}

void Surveyor::rescale_to_metres(double metres_per_unit) {
  for (auto& pose : result_.poses)
    if (pose) pose->translation_m *= metres_per_unit;
  for (auto& place : result_.places)
    if (place) *place *= metres_per_unit;
  for (auto& covariance : result_.covariances) covariance *= metres_per_unit * metres_per_unit;
}

/// The scale by the depth camera, and what it says of each place; false where it does not tell.
bool Surveyor::measure() {
  measured_.clear();
  if (depth_ == nullptr || depth_->views.empty()) return false;
  std::vector<SeenPlace> places;
  std::vector<std::size_t> track_of_place;
  for (std::size_t t = 0; t < rays_.size(); ++t) {
    if (!result_.places[t] || static_cast<int>(rays_[t].size()) < options_.least_views) continue;
    places.push_back({*result_.places[t], {}}), track_of_place.push_back(t);
    for (const SurveyRay& r : rays_[t])
      places.back().seen_s.push_back(tracks_.times_s[number(result_.tracks[t].seen[r.seen])]);
  }
  std::vector<trajectory::TimedPose> path;
  for (std::size_t i = 0; i < result_.poses.size(); ++i)
    if (result_.poses[i])
      path.push_back({tracks_.times_s[i], geometry::inverse(*result_.poses[i])});
  const auto fit = scale_by_depth(places, trajectory::Trajectory(path), *depth_);
  if (!fit) return false;
  rescale_to_metres(fit->metres_per_unit);
  // After that the places follow the depth: they do not judge it again.
  if (!result_.scale) result_.scale = fit->scale;
  measured_.assign(rays_.size(), 0);
  for (std::size_t p = 0; p < places.size(); ++p)
    measured_[track_of_place[p]] = fit->of_place[p] / fit->metres_per_unit;
  return true;
}

/// Leaves out places that are not well known, and counts.
void Surveyor::finish() {
  double squares = 0, count = 0;
  for (std::size_t t = 0; t < rays_.size(); ++t) {
    if (static_cast<int>(rays_[t].size()) < options_.least_views) {
      result_.places[t].reset();
      continue;
    }
    ++result_.followed;
    if (!result_.places[t]) continue;
    double distance = 0;
    for (const SurveyRay& r : rays_[t])
      distance += (pose(result_.tracks[t].seen[r.seen]) * *result_.places[t]).norm() /
                  static_cast<double>(rays_[t].size());
    const double worst = estimation::spectrum_of(result_.covariances[t]).values[2];
    if (!(std::sqrt(worst) < options_.most_sigma_share * distance)) {
      result_.places[t].reset();
      continue;
    }
    ++result_.known;
    for (const SurveyRay& r : rays_[t]) {
      const double sigma_px = result_.tracks[t].seen[r.seen].sigma_px * result_.sigma_scale;
      squares += std::pow(error_of(t, r) * sigma_px, 2), count += 2;
    }
  }
  result_.residual_px = count > 0 ? std::sqrt(squares / count) : 0;
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

}  // namespace

Survey survey(const FeatureTracks& tracks, const geometry::AnyCamera& camera, const Growth& grown,
              const ReconstructOptions& options, const DepthRecord* depth) {
  return Surveyor(tracks, camera, grown, options, depth).run();
}

}  // namespace mixrig::reconstruction

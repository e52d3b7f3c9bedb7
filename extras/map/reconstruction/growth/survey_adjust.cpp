// SPDX-License-Identifier: Apache-2.0
// Places and poses of the survey are adjusted to its rays.
#include <algorithm>

#include "extras/map/reconstruction/growth/surveyor.h"
#include "extras/map/reconstruction/views/bundle.h"
#include "extras/map/reconstruction/views/rays.h"
#include "hal/base/order_statistics.h"
#include "host/math/estimation/points/triangulation.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr double kSurveyOutlierSigmas = 4;
constexpr double kRangeSigma = 0.01;

}  // namespace

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

/// Error of a sighting in sigmas; large where the place lies behind the camera.
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

}  // namespace mixrig::reconstruction

// SPDX-License-Identifier: Apache-2.0
// Metres by the depth camera, and which places are kept.
#include <cmath>

#include "extras/map/reconstruction/growth/map_scale.h"
#include "extras/map/reconstruction/growth/surveyor.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

}  // namespace

void Surveyor::rescale_to_metres(double metres_per_unit) {
  for (auto& pose : result_.poses)
    if (pose) pose->translation_m *= metres_per_unit;
  for (auto& place : result_.places)
    if (place) *place *= metres_per_unit;
  for (auto& covariance : result_.covariances) covariance *= metres_per_unit * metres_per_unit;
}

/// Measures the scale and the distance of each place by the depth camera; false where the depth
/// does not determine the scale.
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

}  // namespace mixrig::reconstruction

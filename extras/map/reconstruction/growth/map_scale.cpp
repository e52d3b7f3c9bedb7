// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/growth/map_scale.h"

#include <algorithm>
#include <cmath>

#include "hal/base/order_statistics.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector3d;

/// Depth in the middle of 3 x 3 pixels that are known and lie on one surface; 0 else.
double smooth_depth(const Image<float>& depth_m, const Eigen::Vector2d& px) {
  const int x = static_cast<int>(std::lround(px.x())), y = static_cast<int>(std::lround(px.y()));
  if (x < 1 || y < 1 || x + 1 >= depth_m.width() || y + 1 >= depth_m.height()) return 0;
  std::vector<float> values;
  for (int j = y - 1; j <= y + 1; ++j)
    for (int i = x - 1; i <= x + 1; ++i) values.push_back(depth_m.row(j)[i]);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  constexpr float kStep = 1.05F;
  if (!(*low > 0) || *high > kStep * *low) return 0;
  return median_in_place(std::span<float>(values));
}

/// Metres per unit by one point in axes of the map's camera. The place of the point in the depth
/// camera depends on the scale, by the distance of the two cameras.
double scale_of_point(const Vector3d& in_camera, const DepthView& view, const DepthCamera& camera,
                      double guess) {
  double scale = guess;
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    const Vector3d p = camera.from_camera * Vector3d(scale * in_camera);
    const auto px = p.z() > 0 ? camera.model.project(p) : std::nullopt;
    if (!px) return 0;
    const double seen_m = smooth_depth(view.depth_m, *px);
    if (!(seen_m > 0)) return 0;
    const double expected_m = camera.is_distance ? p.norm() : p.z();
    const double by_scale = camera.is_distance
                                ? p.dot(camera.from_camera.rotation * in_camera) / p.norm()
                                : (camera.from_camera.rotation * in_camera).z();
    if (!(by_scale > 0)) return 0;
    const double next = scale + (seen_m - expected_m) / by_scale;
    if (!(next > 0)) return 0;
    const bool still = std::abs(next - scale) < 1e-6 * next;
    scale = next;
    if (still) break;
  }
  return scale;
}

double median_of(std::vector<double> values) { return median_in_place(std::span<double>(values)); }

bool is_seen(const SeenPlace& place, double time_s) {
  constexpr double kNear_s = 0.1;
  const auto next = std::lower_bound(place.seen_s.begin(), place.seen_s.end(), time_s - kNear_s);
  return next != place.seen_s.end() && *next <= time_s + kNear_s;
}

/// Median of each place, as a logarithm; NaN where no view shows it. Returns the number of ratios.
int measure_places(std::span<const SeenPlace> places, const trajectory::Trajectory& path,
                   std::span<const DepthView> views, const DepthCamera& camera, double guess,
                   std::vector<double>& logs) {
  std::vector<std::vector<double>> of_place(places.size());
  int measurements = 0;
  for (const DepthView& view : views) {
    const auto pose = path.at(view.time_s);
    if (!pose) continue;
    const geometry::Pose camera_from_map = geometry::inverse(*pose);
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!is_seen(places[i], view.time_s)) continue;
      const double scale = scale_of_point(camera_from_map * places[i].place, view, camera, guess);
      if (scale > 0) of_place[i].push_back(std::log(scale)), ++measurements;
    }
  }
  logs.assign(places.size(), std::nan(""));
  for (std::size_t i = 0; i < places.size(); ++i)
    if (!of_place[i].empty()) logs[i] = median_of(of_place[i]);
  return measurements;
}

struct Mode {
  double middle = 0, deviation = 0;
  int count = 0;  ///< of the values within 2.5 deviations
};

/// Precondition: two values at least.
Mode mode_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  std::size_t best = 0;
  for (std::size_t i = 0; i + half < values.size(); ++i)
    if (values[i + half] - values[i] < values[best + half] - values[best]) best = i;
  constexpr double kHalfOfNormal = 0.6745, kReach = 2.5, kLeast = 0.002;
  Mode mode;
  mode.middle = 0.5 * (values[best] + values[best + half]);
  mode.deviation = std::max(kLeast, 0.5 * (values[best + half] - values[best]) / kHalfOfNormal);
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    double sum = 0;
    mode.count = 0;
    for (const double v : values)
      if (std::abs(v - mode.middle) <= kReach * mode.deviation) sum += v, ++mode.count;
    if (mode.count > 0) mode.middle = sum / mode.count;
  }
  return mode;
}

}  // namespace

std::optional<ScaleFit> scale_by_depth(std::span<const SeenPlace> places,
                                       const trajectory::Trajectory& path,
                                       const DepthRecord& depth) {
  // Without the distance of the two cameras the pixels of a place do not depend on the scale.
  DepthCamera in_one_place = depth.camera;
  in_one_place.from_camera.translation_m.setZero();
  double guess = 1;
  ScaleFit fit;
  constexpr int kPasses = 4, kFewestPlaces = 30;
  constexpr double kMostSigma = 0.05, kReach = 2.5;
  std::vector<double> logs;
  Mode mode;
  for (int pass = 0; pass < kPasses; ++pass) {
    fit.scale.measurements = measure_places(places, path, depth.views,
                                            pass == 0 ? in_one_place : depth.camera, guess, logs);
    std::vector<double> known;
    for (const double v : logs)
      if (std::isfinite(v)) known.push_back(v);
    if (known.size() < kFewestPlaces) return std::nullopt;
    mode = mode_of(std::move(known));
    guess = fit.metres_per_unit = std::exp(mode.middle);
  }
  if (mode.count < kFewestPlaces / 2) return std::nullopt;
  fit.scale.sigma = mode.deviation / std::sqrt(static_cast<double>(mode.count));
  if (!(fit.scale.sigma < kMostSigma)) return std::nullopt;
  for (const double v : logs)
    fit.of_place.push_back(std::abs(v - mode.middle) <= kReach * mode.deviation ? std::exp(v)
                                                                                : 0.0);
  return fit;
}

}  // namespace mixrig::reconstruction

// SPDX-License-Identifier: Apache-2.0
#include "host/reconstruction/map_scale.h"

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

/// Metres per unit by one point in axes of the map's camera: the place of the point in the depth
/// camera hangs on the scale by the distance of the two cameras.
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

/// A first value without the distance of the two cameras: the median of measured over unit depths.
double first_guess(const LearnedMap& map, std::span<const DepthView> views) {
  std::vector<double> depths_m, units;
  for (const DepthView& view : views)
    for (int y = 0; y < view.depth_m.height(); y += 4)
      for (int x = 0; x < view.depth_m.width(); x += 4)
        if (view.depth_m.row(y)[x] > 0) depths_m.push_back(view.depth_m.row(y)[x]);
  for (const MapPoint& p : map.points) units.push_back(p.place.norm());
  const double unit = median_of(units);
  return unit > 0 ? median_of(depths_m) / unit : 0;
}

}  // namespace

std::optional<ScaleFit> scale_by_depth(const LearnedMap& map, std::span<const DepthView> views,
                                       const DepthCamera& camera) {
  const trajectory::Trajectory path(map.path);
  double guess = first_guess(map, views);
  if (!(guess > 0)) return std::nullopt;
  ScaleFit fit;
  constexpr int kPasses = 4;
  constexpr std::size_t kFewestPoints = 30;
  constexpr double kMostSigma = 0.05;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<std::vector<double>> of_point(map.points.size());
    fit.scale.measurements = 0;
    for (const DepthView& view : views) {
      const auto pose = path.at(view.time_s);
      if (!pose) continue;
      const geometry::Pose camera_from_map = geometry::inverse(*pose);
      for (std::size_t i = 0; i < map.points.size(); ++i) {
        const double scale =
            scale_of_point(camera_from_map * map.points[i].place, view, camera, guess);
        if (scale > 0) of_point[i].push_back(std::log(scale)), ++fit.scale.measurements;
      }
    }
    std::vector<double> logs;
    for (const auto& values : of_point)
      if (!values.empty()) logs.push_back(median_of(values));
    if (logs.size() < kFewestPoints) return std::nullopt;
    const double middle = median_of(logs);
    for (double& value : logs) value = std::abs(value - middle);
    constexpr double kSigmaOfDeviation = 1.4826, kSigmaOfMedian = 1.2533;
    fit.scale.sigma = kSigmaOfMedian * kSigmaOfDeviation * median_of(logs) /
                      std::sqrt(static_cast<double>(logs.size()));
    guess = fit.metres_per_unit = std::exp(middle);
  }
  if (!(fit.scale.sigma < kMostSigma)) return std::nullopt;
  return fit;
}

}  // namespace mixrig::reconstruction

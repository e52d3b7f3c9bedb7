// SPDX-License-Identifier: Apache-2.0
// Finding the floor: planes by random sampling (Fischler and Bolles 1981), refined by least
// squares. Samples are drawn close together: of a plane with 4 % of all points, three independent
// points are a sample only once in 16000 draws.
#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "hal/base/order_statistics.h"
#include "host/math/estimation/consensus.h"
#include "host/room/background/static_background.h"

namespace mixrig::model {
namespace {

constexpr int kGridColumns = 128;     ///< points looked at across the picture
constexpr int kHypotheses = 2000;     ///< a plane with 4 % of the points is missed once in 1e8
constexpr int kPlanes = 4;            ///< extracted at most, largest first
constexpr double kLeastShare = 0.04;  ///< of the points, that a plane must hold
constexpr double kLeastOfLargest =
    0.25;  ///< of the largest plane's points, that a lower plane must hold
constexpr double kCosMaxTilt = 0.70710678;

/// Grid of points in camera axes; z = 0 where unknown.
struct Grid {
  int width = 0, height = 0;
  std::vector<Eigen::Vector3d> points;
  std::vector<int> known;  ///< indices of points that are known and not yet part of a plane
};

Grid make_grid(const geometry::Pinhole& view, ImageView<const float> depth_m) {
  const int step = std::max(1, depth_m.size.width / kGridColumns);
  Grid grid{
      (depth_m.size.width + step - 1) / step, (depth_m.size.height + step - 1) / step, {}, {}};
  for (int gy = 0; gy < grid.height; ++gy)
    for (int gx = 0; gx < grid.width; ++gx) {
      const int x = gx * step, y = gy * step;
      const double z = depth_m.at(x, y);
      const Eigen::Vector2d ray = view.unproject({x, y});
      if (z > 0 && std::isfinite(z)) grid.known.push_back(static_cast<int>(grid.points.size()));
      grid.points.emplace_back(ray.x() * z, ray.y() * z, z);
    }
  return grid;
}

/// How far a point of a plane may lie off it: noise of depth cameras grows with distance squared.
double tolerance_m(const Eigen::Vector3d& p) { return 0.015 + 0.003 * p.z() * p.z(); }

bool is_near(const geometry::Plane& plane, const Eigen::Vector3d& p, double factor = 1.0) {
  return std::abs(plane.signed_distance_m(p)) < factor * tolerance_m(p);
}

/// Turns the normal towards the camera; false if the plane is too steep for a floor or above the
/// camera.
bool orient(geometry::Plane& plane) {
  if (plane.offset_m < 0) plane = {-plane.normal, -plane.offset_m};
  return -plane.normal.y() > kCosMaxTilt;
}

int support(const Grid& grid, const geometry::Plane& plane) {
  return static_cast<int>(std::count_if(grid.known.begin(), grid.known.end(), [&](int i) {
    return is_near(plane, grid.points[static_cast<std::size_t>(i)]);
  }));
}

/// A plane through a random point and two more of its surroundings.
std::optional<geometry::Plane> hypothesis(const Grid& grid, std::mt19937& random) {
  const int seed = grid.known[random() % grid.known.size()];
  const auto nearby = [&]() -> const Eigen::Vector3d& {
    const int reach = 1 + kGridColumns / 8;
    const auto span = static_cast<unsigned>(2 * reach + 1);
    const int x = std::clamp(seed % grid.width + static_cast<int>(random() % span) - reach, 0,
                             grid.width - 1);
    const int y = std::clamp(seed / grid.width + static_cast<int>(random() % span) - reach, 0,
                             grid.height - 1);
    return grid.points[static_cast<std::size_t>(y * grid.width + x)];
  };
  const Eigen::Vector3d &a = grid.points[static_cast<std::size_t>(seed)], &b = nearby(),
                        &c = nearby();
  const Eigen::Vector3d cross = (b - a).cross(c - a);
  if (b.z() <= 0 || c.z() <= 0 || cross.norm() < 1e-6) return std::nullopt;
  geometry::Plane plane;
  plane.normal = cross.normalized();
  plane.offset_m = -plane.normal.dot(a);
  if (!orient(plane)) return std::nullopt;
  return plane;
}

/// Repeated least squares over the points near the plane; nullopt if it stops being a floor. The
/// tolerance shrinks to the actual noise, so that the lowest points of a wall do not tilt the
/// plane.
std::optional<geometry::Plane> refine(const Grid& grid, geometry::Plane plane) {
  constexpr double kSigmas = 3.0, kSigmaPerMad = 1.4826, kLeastFactor = 0.1;
  double factor = 1.0;
  std::vector<Eigen::Vector3d> near;
  std::vector<double> deviations;
  for (int round = 0; round < 5; ++round) {
    near.clear();
    deviations.clear();
    for (const int i : grid.known)
      if (const auto& p = grid.points[static_cast<std::size_t>(i)]; is_near(plane, p, factor))
        near.push_back(p);
    auto fitted = geometry::fit_plane(near);
    if (!fitted || !orient(*fitted)) return std::nullopt;
    plane = *fitted;
    for (const auto& p : near)
      deviations.push_back(std::abs(plane.signed_distance_m(p)) / tolerance_m(p));
    const double typical = upper_median_in_place(std::span(deviations));
    factor = std::clamp(kSigmas * kSigmaPerMad * typical, kLeastFactor, 1.0);
  }
  return plane;
}

std::optional<geometry::Plane> largest_plane(const Grid& grid, std::mt19937& random) {
  estimation::BestModel<geometry::Plane> best(static_cast<int>(grid.known.size()), 1.0);
  const auto misses = [&](const geometry::Plane& plane, int k) {
    const int point = grid.known[static_cast<std::size_t>(k)];
    return is_near(plane, grid.points[static_cast<std::size_t>(point)]) ? 0.0 : 1.0;
  };
  for (int i = 0; i < kHypotheses; ++i)
    if (const auto plane = hypothesis(grid, random)) best.offer(*plane, misses);
  return best.model() ? refine(grid, *best.model()) : std::nullopt;
}

}  // namespace

std::optional<geometry::Plane> find_floor(const geometry::Pinhole& view,
                                          ImageView<const float> depth_m) {
  Grid grid = make_grid(view, depth_m);
  const double least = std::max(50.0, kLeastShare * static_cast<double>(grid.known.size()));
  std::mt19937 random(1);
  std::optional<geometry::Plane> floor;
  int largest = 0;
  for (int round = 0; round < kPlanes && static_cast<double>(grid.known.size()) >= least; ++round) {
    const auto plane = largest_plane(grid, random);
    if (!plane) break;
    const int count = support(grid, *plane);
    largest = std::max(largest, count);
    if (count < least || count < kLeastOfLargest * largest) break;
    // The floor is the lowest plane: so a table above it is not taken.
    if (!floor || plane->offset_m > floor->offset_m) floor = plane;
    std::erase_if(grid.known, [&](int i) {
      return is_near(*plane, grid.points[static_cast<std::size_t>(i)], 2.0);
    });
  }
  return floor;
}

}  // namespace mixrig::model

// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/seen_corners.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "hal/base/angles.h"
#include "hal/base/order_statistics.h"

namespace mixrig::depth {
namespace {

using Eigen::Vector3d;

constexpr double kFarthest_m = 1.5;    ///< from the corner, of what its planes are fitted to
constexpr int kFewestCells = 12;       ///< of a plane's far part
constexpr double kLeastWidth_m = 0.2;  ///< of a plane's far part, across the corner
constexpr double kLeastLength_m = 0.2;
constexpr double kGate_m = 0.2;  ///< an error beyond it is another surface
constexpr double kLeastAgreeing = 0.7;
constexpr std::size_t kFewestPixels = 30;

struct Line {
  Vector3d at_m = Vector3d::Zero(), along = Vector3d::UnitX();
  double place_m(const Vector3d& p) const { return along.dot(p - at_m); }
  double away_m(const Vector3d& p) const { return along.cross(p - at_m).norm(); }
};

/// Where two planes meet, near the axis' origin; nothing unless they meet at 60 to 120 degrees.
std::optional<Line> line_of(const SeenPlane& a, const SeenPlane& b) {
  const Vector3d along = a.normal().cross(b.normal());
  if (along.norm() < std::sin(60 * kDeg)) return std::nullopt;
  Eigen::Matrix3d m;
  m << a.inverse_per_m.transpose(), b.inverse_per_m.transpose(), along.transpose();
  return Line{m.partialPivLu().solve(Vector3d(1, 1, 0)), along.normalized()};
}

struct Span {
  double from_m = 0, to_m = 0;
};

/// Places along the line of a plane's cells near it.
std::optional<Span> beside(const CellGrid& grid, const SeenPlane& plane, const Line& line) {
  std::vector<double> places_m;
  for (const int i : plane.cells) {
    const Vector3d p = grid.cells[static_cast<std::size_t>(i)].point_m();
    if (line.away_m(p) < kCornerLimits_m.back()) places_m.push_back(line.place_m(p));
  }
  if (places_m.size() < 5) return std::nullopt;
  std::sort(places_m.begin(), places_m.end());
  const std::size_t cut = places_m.size() / 20;
  return Span{places_m[cut], places_m[places_m.size() - 1 - cut]};
}

/// The plane of the cells beyond the last limit; nothing where too few are there.
std::optional<SeenPlane> far_part(const CellGrid& grid, const SeenPlane& plane, const Line& line) {
  std::vector<int> cells;
  double nearest_m = kFarthest_m, farthest_m = 0;
  for (const int i : plane.cells) {
    const double away_m = line.away_m(grid.cells[static_cast<std::size_t>(i)].point_m());
    if (away_m < kCornerLimits_m.back() || away_m > kFarthest_m) continue;
    nearest_m = std::min(nearest_m, away_m), farthest_m = std::max(farthest_m, away_m);
    cells.push_back(i);
  }
  if (static_cast<int>(cells.size()) < kFewestCells || farthest_m - nearest_m < kLeastWidth_m)
    return std::nullopt;
  SeenPlane fit = fit_cells(grid, std::move(cells));
  if (fit.inverse_per_m.isZero()) return std::nullopt;
  return fit;
}

/// Whether most of a plane's cells lie on the camera's side of another one.
bool before(const CellGrid& grid, const SeenPlane& plane, const SeenPlane& other) {
  const auto on_side = std::count_if(plane.cells.begin(), plane.cells.end(), [&](int i) {
    return other.beyond_m(grid.cells[static_cast<std::size_t>(i)].point_m()) < 0;
  });
  return 10 * on_side > 9 * static_cast<std::ptrdiff_t>(plane.cells.size());
}

double band_error_m(std::vector<double>& errors_m) {
  const std::size_t all = errors_m.size();
  std::erase_if(errors_m, [](double e) { return std::abs(e) > kGate_m; });
  const auto agreeing = static_cast<double>(errors_m.size());
  if (all < kFewestPixels || agreeing < kLeastAgreeing * static_cast<double>(all))
    return std::numeric_limits<double>::quiet_NaN();
  return upper_median_in_place(std::span(errors_m));
}

/// Measures a corner of two fitted planes over the pixels whose rays meet them near the line.
SeenCorner measure_corner(ImageView<const float> z_m, const PixelRays& rays, const SeenPlane& a,
                          const SeenPlane& b, const Line& line, const Span& span) {
  std::array<std::vector<double>, kCornerBands> errors_m;
  std::vector<double> distances_m;
  for (int y = 0; y < z_m.size.height; ++y)
    for (int x = 0; x < z_m.size.width; ++x) {
      const Vector3d ray = rays.at(x, y);
      const double inverse = std::max(a.inverse_per_m.dot(ray), b.inverse_per_m.dot(ray));
      if (!(inverse > 0)) continue;
      const Vector3d p = ray / inverse;
      const double away_m = line.away_m(p), place_m = line.place_m(p), z = z_m.row(y)[x];
      if (away_m >= kCornerLimits_m.back() || place_m < span.from_m || place_m > span.to_m)
        continue;
      if (!(z > 0) || !std::isfinite(z)) continue;
      const auto next = std::upper_bound(kCornerLimits_m.begin(), kCornerLimits_m.end(), away_m);
      errors_m[static_cast<std::size_t>(next - kCornerLimits_m.begin() - 1)].push_back((z - p.z()) *
                                                                                       ray.norm());
      distances_m.push_back(p.norm());
    }
  SeenCorner corner;
  corner.angle_deg = 180 - std::acos(std::clamp(a.normal().dot(b.normal()), -1.0, 1.0)) / kDeg;
  corner.distance_m = upper_median_in_place(std::span(distances_m));
  for (std::size_t i = 0; i < kCornerBands; ++i) corner.error_m[i] = band_error_m(errors_m[i]);
  return corner;
}

std::optional<SeenCorner> corner_of(ImageView<const float> z_m, const PixelRays& rays,
                                    const CellGrid& grid, const SeenPlane& a, const SeenPlane& b) {
  const auto rough = line_of(a, b);
  if (!rough) return std::nullopt;
  const auto far_a = far_part(grid, a, *rough), far_b = far_part(grid, b, *rough);
  if (!far_a || !far_b || !before(grid, *far_a, *far_b) || !before(grid, *far_b, *far_a))
    return std::nullopt;
  const auto line = line_of(*far_a, *far_b);
  if (!line) return std::nullopt;
  const auto beside_a = beside(grid, a, *line), beside_b = beside(grid, b, *line);
  if (!beside_a || !beside_b) return std::nullopt;
  const Span span{std::max(beside_a->from_m, beside_b->from_m),
                  std::min(beside_a->to_m, beside_b->to_m)};
  if (span.to_m - span.from_m < kLeastLength_m) return std::nullopt;
  const SeenCorner corner = measure_corner(z_m, rays, *far_a, *far_b, *line, span);
  if (std::all_of(corner.error_m.begin(), corner.error_m.end(),
                  [](double e) { return std::isnan(e); }))
    return std::nullopt;
  return corner;
}

}  // namespace

std::vector<SeenCorner> find_corners(ImageView<const float> z_m, const PixelRays& rays,
                                     const CellGrid& grid, const std::vector<SeenPlane>& planes) {
  std::vector<SeenCorner> corners;
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t k = i + 1; k < planes.size(); ++k)
      if (const auto corner = corner_of(z_m, rays, grid, planes[i], planes[k]))
        corners.push_back(*corner);
  return corners;
}

}  // namespace mixrig::depth

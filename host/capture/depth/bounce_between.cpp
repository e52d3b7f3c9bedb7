// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/bounce_between.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include "hal/base/angles.h"
#include "host/capture/depth/seen_corners.h"

namespace mixrig::depth {
namespace {

using Eigen::Vector3d;

constexpr double kSpeedOfLight_m_s = 299792458.0;
constexpr int kNormalReach = 2, kFewestForNormal = 6;  ///< cells around one
constexpr double kSameSurface = 0.08;                  ///< of the depth
constexpr double kLeastSlant = 0.05;                   ///< cosine of the angle of incidence
constexpr double kMostCell_m2 = 0.2;
constexpr int kRounds = 2;  ///< the second computes the light from corrected surfaces
constexpr double kTrialReflectivity = 0.5, kMostReflectivity = 0.9;
constexpr std::size_t kFewestCorners = 5;
constexpr double kLeastError_m = 0.004;  ///< beside corners; what their shape alone can make
constexpr std::size_t kFirstBand = 1, kEndBand = 3;

/// A lit piece of surface.
struct Patch {
  Vector3d at_m, normal;  ///< the normal points to the camera
  double distance_m = 0;
  double light_per_m2 = 0;  ///< that arrives from the camera, 1 at 1 m and at right angles
  double area_m2 = 0;
  std::size_t cell = 0;
};

std::optional<Patch> patch_of(const CellGrid& grid, int cx, int cy) {
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y * grid.size.width + x);
  };
  const DepthCell& middle = grid.cells[index(cx, cy)];
  if (!(middle.inverse_per_m > 0)) return std::nullopt;
  const Vector3d p = middle.point_m();
  std::vector<int> around;
  for (int y = std::max(0, cy - kNormalReach);
       y <= std::min(grid.size.height - 1, cy + kNormalReach); ++y)
    for (int x = std::max(0, cx - kNormalReach);
         x <= std::min(grid.size.width - 1, cx + kNormalReach); ++x) {
      const double inverse = grid.cells[index(x, y)].inverse_per_m;
      if (inverse > 0 && std::abs(1 / inverse - p.z()) < kSameSurface * p.z())
        around.push_back(y * grid.size.width + x);
    }
  if (static_cast<int>(around.size()) < kFewestForNormal) return std::nullopt;
  const SeenPlane plane = fit_cells(grid, std::move(around));
  if (plane.inverse_per_m.isZero()) return std::nullopt;
  Patch patch{p, plane.normal(), p.norm(), 0, 0, index(cx, cy)};
  if (patch.normal.dot(p) > 0) patch.normal = -patch.normal;
  const double slant = std::max(kLeastSlant, -patch.normal.dot(p) / patch.distance_m);
  patch.light_per_m2 = slant / (patch.distance_m * patch.distance_m);
  const double across = std::max(kLeastSlant, -patch.normal.dot(middle.ray));
  patch.area_m2 = std::min(kMostCell_m2, middle.area_per_m2 * p.z() * p.z() / across);
  return patch;
}

std::vector<Patch> patches_of(const CellGrid& grid) {
  std::vector<Patch> patches;
  for (int y = 0; y < grid.size.height; ++y)
    for (int x = 0; x < grid.size.width; ++x)
      if (const auto patch = patch_of(grid, x, y)) patches.push_back(*patch);
  return patches;
}

/// What the others' light adds to the distance of one patch. Each is a diffuse disc of its area
/// (form factor of a disc and a point).
double added_m(const std::vector<Patch>& patches, const Patch& to, const BounceModel& model) {
  const double phase_per_m = 2 * kPi * model.modulation_hz / kSpeedOfLight_m_s;
  std::complex<double> sum = 0;
  for (const Patch& from : patches) {
    const Vector3d way = to.at_m - from.at_m;
    const double leaving = from.normal.dot(way), arriving = -to.normal.dot(way);
    if (leaving <= 0 || arriving <= 0) continue;
    const double squared = way.squaredNorm();
    const double share =
        leaving * arriving * from.area_m2 / (squared * (kPi * squared + from.area_m2));
    const double detour_m = from.distance_m + std::sqrt(squared) - to.distance_m;
    sum += from.light_per_m2 * share * std::polar(1.0, phase_per_m * detour_m);
  }
  return std::arg(1.0 + model.reflectivity * sum / to.light_per_m2) / (2 * phase_per_m);
}

/// Added distances between the cells around a pixel that lie on its surface; 0 where none does.
double between_cells_m(const CellGrid& grid, const std::vector<double>& cells_m, int x, int y,
                       double z_m) {
  const double u = (x - 0.5 * (grid.side_px - 1)) / grid.side_px,
               v = (y - 0.5 * (grid.side_px - 1)) / grid.side_px;
  const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
  double sum_m = 0, weights = 1e-9;
  for (int j = top; j <= top + 1; ++j)
    for (int i = left; i <= left + 1; ++i) {
      const int cx = std::clamp(i, 0, grid.size.width - 1),
                cy = std::clamp(j, 0, grid.size.height - 1);
      const auto at = static_cast<std::size_t>(cy * grid.size.width + cx);
      if (std::isnan(cells_m[at])) continue;
      if (std::abs(grid.cells[at].point_m().z() - z_m) > kSameSurface * z_m) continue;
      const double weight = (1 - std::abs(u - i)) * (1 - std::abs(v - j)) + 1e-6;
      sum_m += weight * cells_m[at], weights += weight;
    }
  return sum_m / weights;
}

/// Computes the added distances of `shape_m` and writes `measured_m` less these into `shape_m`.
void subtract(const BounceModel& model, const PixelRays& rays, ImageView<const float> measured_m,
              ImageView<float> shape_m) {
  const CellGrid grid = cells_of(shape_m, rays);
  if (grid.cells.empty()) return;
  const std::vector<Patch> patches = patches_of(grid);
  std::vector<double> cells_m(grid.cells.size(), std::numeric_limits<double>::quiet_NaN());
  for (const Patch& patch : patches) cells_m[patch.cell] = added_m(patches, patch, model);
  for (int y = 0; y < shape_m.size.height; ++y)
    for (int x = 0; x < shape_m.size.width; ++x) {
      float& z = shape_m.row(y)[x];
      if (!(z > 0) || !std::isfinite(z)) continue;
      const double ray = rays.at(x, y).norm();
      if (!std::isfinite(ray)) continue;
      const double added = between_cells_m(grid, cells_m, x, y, z) / ray;
      z = std::max(0.0F, measured_m.row(y)[x] - static_cast<float>(added));
    }
}

}  // namespace

void take_out_bounce(const BounceModel& model, const PixelRays& rays, ImageView<float> z_m) {
  if (!(model.modulation_hz > 0) || !(model.reflectivity > 0)) return;
  Image<float> measured_m(z_m.size);
  for (int y = 0; y < z_m.size.height; ++y)
    std::copy_n(z_m.row(y), z_m.size.width, measured_m.row(y));
  for (int round = 0; round < kRounds; ++round) subtract(model, rays, measured_m, z_m);
}

CornerError corner_error(std::span<const Image<float>> pictures_m, const PixelRays& rays) {
  CornerError out;
  std::size_t bands = 0;
  for (const Image<float>& z_m : pictures_m) {
    const CellGrid grid = cells_of(z_m, rays);
    for (const SeenCorner& corner : find_corners(z_m, rays, grid, find_planes(grid))) {
      ++out.corners;
      for (std::size_t i = kFirstBand; i < kEndBand; ++i)
        if (!std::isnan(corner.error_m[i])) out.error_m += corner.error_m[i], ++bands;
    }
  }
  out.error_m /= static_cast<double>(std::max<std::size_t>(bands, 1));
  return out;
}

std::optional<double> find_reflectivity(std::span<const Image<float>> pictures_m,
                                        const PixelRays& rays, double modulation_hz) {
  const CornerError before = corner_error(pictures_m, rays);
  if (before.corners < kFewestCorners || before.error_m > -kLeastError_m) return std::nullopt;
  std::vector<Image<float>> trial(pictures_m.begin(), pictures_m.end());
  for (Image<float>& z_m : trial) take_out_bounce({modulation_hz, kTrialReflectivity}, rays, z_m);
  const CornerError after = corner_error(trial, rays);
  if (after.corners < kFewestCorners || after.error_m <= before.error_m) return std::nullopt;
  const double found = kTrialReflectivity * before.error_m / (before.error_m - after.error_m);
  if (found > kMostReflectivity) return std::nullopt;
  return found;
}

}  // namespace mixrig::depth

// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/seen_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "hal/base/order_statistics.h"

namespace mixrig::depth {
namespace {

using Eigen::Vector3d;

constexpr int kCellsInARow = 64, kLeastSide_px = 4;
constexpr double kLeastKnown = 0.7;  ///< share of a cell's pixels
constexpr double kMostEdge = 0.03;   ///< residual inside a cell over its depth; more is an edge
constexpr double kNear_m = 0.02, kNearShare = 0.01;  ///< a cell this near lies on a plane
constexpr double kLeastShare = 0.04;                 ///< of the picture
constexpr int kSeedReach = 3, kSeedStep = 3, kGrowths = 4;

/// Mean and local plane of one cell.
DepthCell measure_cell(ImageView<const float> z_m, const PixelRays& rays, int x0, int y0,
                       int side) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero(), ray = Vector3d::Zero();
  double squares = 0;
  int known = 0;
  for (int y = y0; y < y0 + side; ++y)
    for (int x = x0; x < x0 + side; ++x) {
      const float z = z_m.row(y)[x];
      const Vector3d r = rays.at(x, y);
      if (!(z > 0) || !std::isfinite(z) || !r.allFinite()) continue;
      const Vector3d place(x - x0, y - y0, 1);
      normal += place * place.transpose(), right += place / z;
      squares += 1 / (static_cast<double>(z) * z), ray += r, ++known;
    }
  DepthCell cell;
  if (known < kLeastKnown * side * side) return cell;
  const Vector3d fit = normal.ldlt().solve(right);
  const double inverse = right.z() / known;
  const double residual = std::sqrt(std::max(0.0, squares - fit.dot(right)) / (known - 3));
  if (!(residual / inverse < kMostEdge)) return cell;
  cell.ray = ray / known;
  cell.inverse_per_m = inverse;
  cell.sigma_m = residual / (inverse * inverse * std::sqrt(known));
  const Vector3d across = rays.at(x0 + side - 1, y0) - rays.at(x0, y0),
                 down = rays.at(x0, y0 + side - 1) - rays.at(x0, y0);
  const double area = std::abs(across.x() * down.y() - across.y() * down.x());
  cell.area_per_m2 = std::isfinite(area) ? area * side * side / ((side - 1.0) * (side - 1)) : 0;
  return cell;
}

double nearness_m(const DepthCell& cell) { return kNear_m + kNearShare / cell.inverse_per_m; }

bool lies_on(const SeenPlane& plane, const DepthCell& cell) {
  return cell.inverse_per_m > 0 && std::abs(plane.beyond_m(cell.point_m())) < nearness_m(cell);
}

/// Cells that lie on the plane and are connected to `seed`; none that is `taken`.
std::vector<int> connected(const CellGrid& grid, const SeenPlane& plane, int seed,
                           const std::vector<bool>& taken) {
  std::vector<bool> seen = taken;
  std::vector<int> cells;
  const auto visit = [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    if (seen[at] || !lies_on(plane, grid.cells[at])) return;
    seen[at] = true, cells.push_back(i);
  };
  visit(seed);
  for (std::size_t next = 0; next < cells.size(); ++next) {
    const int i = cells[next], x = i % grid.size.width;
    if (x > 0) visit(i - 1);
    if (x + 1 < grid.size.width) visit(i + 1);
    if (i >= grid.size.width) visit(i - grid.size.width);
    if (i + grid.size.width < static_cast<int>(grid.cells.size())) visit(i + grid.size.width);
  }
  return cells;
}

struct Seed {
  int cell = 0;
  double rms_m = 0;
  SeenPlane plane;
};

/// The plane of the cells around one; none where they are no plane.
bool seed_at(const CellGrid& grid, int cx, int cy, Seed& seed) {
  std::vector<int> cells;
  for (int y = cy - kSeedReach; y <= cy + kSeedReach; ++y)
    for (int x = cx - kSeedReach; x <= cx + kSeedReach; ++x) {
      const int i = y * grid.size.width + x;
      if (grid.cells[static_cast<std::size_t>(i)].inverse_per_m > 0) cells.push_back(i);
    }
  constexpr int kSide = 2 * kSeedReach + 1;
  if (static_cast<int>(cells.size()) < kSide * kSide * 4 / 5) return false;
  seed.cell = cy * grid.size.width + cx;
  const DepthCell& middle = grid.cells[static_cast<std::size_t>(seed.cell)];
  seed.plane = fit_cells(grid, std::move(cells));
  if (seed.plane.inverse_per_m.isZero() || !(middle.inverse_per_m > 0)) return false;
  double squares = 0;
  for (const int i : seed.plane.cells)
    squares += std::pow(seed.plane.beyond_m(grid.cells[static_cast<std::size_t>(i)].point_m()), 2);
  seed.rms_m = std::sqrt(squares / static_cast<double>(seed.plane.cells.size()));
  return seed.rms_m < 0.5 * nearness_m(middle);
}

std::vector<Seed> seeds_of(const CellGrid& grid) {
  std::vector<Seed> seeds;
  for (int y = kSeedReach; y + kSeedReach < grid.size.height; y += kSeedStep)
    for (int x = kSeedReach; x + kSeedReach < grid.size.width; x += kSeedStep)
      if (Seed seed; seed_at(grid, x, y, seed)) seeds.push_back(std::move(seed));
  std::stable_sort(seeds.begin(), seeds.end(),
                   [](const Seed& a, const Seed& b) { return a.rms_m < b.rms_m; });
  return seeds;
}

}  // namespace

PixelRays::PixelRays(const geometry::CameraModel& camera)
    : x(camera.size_px()), y(camera.size_px()) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < y.height(); ++v)
    for (int u = 0; u < y.width(); ++u) {
      const auto ray = camera.unproject({u, v});
      x.at(u, v) = ray ? static_cast<float>(ray->x()) : kNone;
      y.at(u, v) = ray ? static_cast<float>(ray->y()) : kNone;
    }
}

void PixelRays::to_depth(ImageView<float> distance_m) const {
  for (int v = 0; v < distance_m.size.height; ++v)
    for (int u = 0; u < distance_m.size.width; ++u)
      distance_m.row(v)[u] /= static_cast<float>(at(u, v).norm());
}

void PixelRays::to_distance(ImageView<float> z_m) const {
  for (int v = 0; v < z_m.size.height; ++v)
    for (int u = 0; u < z_m.size.width; ++u) z_m.row(v)[u] *= static_cast<float>(at(u, v).norm());
}

CellGrid cells_of(ImageView<const float> z_m, const PixelRays& rays) {
  CellGrid grid;
  grid.side_px = std::max(kLeastSide_px, z_m.size.width / kCellsInARow);
  grid.size = {z_m.size.width / grid.side_px, z_m.size.height / grid.side_px};
  for (int y = 0; y < grid.size.height; ++y)
    for (int x = 0; x < grid.size.width; ++x)
      grid.cells.push_back(
          measure_cell(z_m, rays, x * grid.side_px, y * grid.side_px, grid.side_px));
  return grid;
}

SeenPlane fit_cells(const CellGrid& grid, std::vector<int> cells) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const int i : cells) {
    const Vector3d p = grid.cells[static_cast<std::size_t>(i)].point_m();
    normal += p * p.transpose(), right += p;
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  const Vector3d plane = solver.solve(right);
  const bool determined =
      cells.size() >= 3 && solver.rcond() > 1e-9 && plane.allFinite() && plane.norm() > 1e-6;
  return {determined ? plane : Vector3d::Zero(), std::move(cells)};
}

std::vector<SeenPlane> find_planes(const CellGrid& grid) {
  std::vector<SeenPlane> planes;
  std::vector<bool> taken(grid.cells.size(), false);
  const auto least = static_cast<std::size_t>(kLeastShare * static_cast<double>(taken.size()));
  for (Seed& seed : seeds_of(grid)) {
    if (taken[static_cast<std::size_t>(seed.cell)]) continue;
    SeenPlane plane = std::move(seed.plane);
    for (int i = 0; i < kGrowths && !plane.inverse_per_m.isZero(); ++i)
      plane = fit_cells(grid, connected(grid, plane, seed.cell, taken));
    if (plane.cells.size() < least || plane.inverse_per_m.isZero()) continue;
    for (const int i : plane.cells) taken[static_cast<std::size_t>(i)] = true;
    planes.push_back(std::move(plane));
  }
  return planes;
}

Flatness flatness_of(const CellGrid& grid, const SeenPlane& plane) {
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  const Vector3d n = plane.normal();
  const Vector3d u = n.unitOrthogonal(), v = n.cross(u);
  Flatness out;
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Vector6d right = Vector6d::Zero();
  double squares = 0, noise = 0;
  std::vector<double> distances_m;
  for (const int i : plane.cells) {
    const DepthCell& cell = grid.cells[static_cast<std::size_t>(i)];
    const Vector3d p = cell.point_m();
    const double e = plane.beyond_m(p), a = u.dot(p), b = v.dot(p), slant = n.dot(cell.ray);
    const Vector6d powers(1, a, b, a * a, a * b, b * b);
    normal += powers * powers.transpose(), right += e * powers;
    squares += e * e, noise += std::pow(cell.sigma_m * slant, 2);
    out.area_m2 += cell.area_per_m2 * p.z() * p.z() / std::max(slant, 0.05);
    distances_m.push_back(p.norm());
  }
  const auto count = static_cast<double>(plane.cells.size());
  out.distance_m = upper_median(distances_m);
  out.rms_m = std::sqrt(std::max(0.0, squares - noise) / count);
  out.bend_m = std::sqrt(std::max(0.0, normal.ldlt().solve(right).dot(right)) / count);
  return out;
}

}  // namespace mixrig::depth

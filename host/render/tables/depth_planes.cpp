// SPDX-License-Identifier: Apache-2.0
#include "host/render/tables/depth_planes.h"

#include <algorithm>
#include <optional>

#include "host/math/geometry/linear.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {
namespace {
constexpr int kSeeds = 400, kScoredCells = 3000;  // of all planes; of each plane
constexpr double kLeastShare = 0.01;              // least share of the known cells on a plane
constexpr int kWindow = 3, kReach = 2;            // cells to either side
constexpr double kWindowShare = 0.7, kWindowMean = 1;

Cell cell_of(ImageView<const float> depth_m, const geometry::Pinhole& view,
             const NoiseParams& noise, const Rect& rect) {
  Cell cell;
  int known = 0;
  for (int v = rect.y0; v < rect.y1; ++v)
    for (int u = rect.x0; u < rect.x1; ++u) {
      const float z = depth_m.row(v)[u];
      if (!(z > 0) || !std::isfinite(z)) continue;
      cell.x += (u - view.cx_px) / view.fx_px, cell.y += (v - view.cy_px) / view.fy_px;
      cell.w += 1 / static_cast<double>(z);
      ++known;
    }
  if (2 * known < (rect.x1 - rect.x0) * (rect.y1 - rect.y0) || known == 0) return {};
  cell.x /= known, cell.y /= known, cell.w /= known;
  cell.sigma = sigma_w(noise, cell.w);
  return cell;
}

/// Fits a plane by weighted least squares to the cells that `use` accepts.
template <typename Use>
std::optional<WPlane> fit(const std::vector<const Cell*>& cells, Use&& use) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Cell* cell : cells) {
    if (!use(*cell)) continue;
    const Eigen::Vector3d ray(cell->x, cell->y, 1);
    const double weight = 1 / (cell->sigma * cell->sigma);
    a += weight * ray * ray.transpose(), b += weight * cell->w * ray;
    ++count;
  }
  if (count < 6) return std::nullopt;
  const geometry::SymmetricSolver<3> solved(a);
  if (!solved.is_solved() || !(solved.reciprocal_condition() > 1e-12)) return std::nullopt;
  return WPlane{solved.solve(b)};
}

/// Known cells within kWindow of a cell.
std::vector<const Cell*> around(const Cells& cells, int i, int j) {
  std::vector<const Cell*> found;
  for (int y = std::max(0, j - kWindow); y <= std::min(cells.rows - 1, j + kWindow); ++y)
    for (int x = std::max(0, i - kWindow); x <= std::min(cells.columns - 1, i + kWindow); ++x)
      if (cells.at(x, y).w > 0) found.push_back(&cells.at(x, y));
  return found;
}

/// Candidate planes, fitted around places all over the picture, on which all their cells lie.
std::vector<WPlane> hypotheses(const Cells& cells) {
  std::vector<WPlane> found;
  const int step =
      std::max(1, static_cast<int>(std::sqrt(static_cast<double>(cells.cells.size()) / kSeeds)));
  for (int j = step / 2; j < cells.rows; j += step)
    for (int i = step / 2; i < cells.columns; i += step) {
      const std::vector<const Cell*> near = around(cells, i, j);
      const auto plane = fit(near, [](const Cell&) { return true; });
      if (!plane) continue;
      const auto off = std::count_if(near.begin(), near.end(), [&](const Cell* cell) {
        return std::abs(cell->residual(*plane)) > kOnPlane;
      });
      if (off == 0) found.push_back(*plane);
    }
  return found;
}

/// Whether the cells around lie on the plane, with residuals on both sides of it alike.
bool is_core(const Cells& cells, int i, int j, const WPlane& plane) {
  int known = 0, on = 0;
  double sum = 0;
  for (int y = std::max(0, j - kWindow); y <= std::min(cells.rows - 1, j + kWindow); ++y)
    for (int x = std::max(0, i - kWindow); x <= std::min(cells.columns - 1, i + kWindow); ++x) {
      const Cell& cell = cells.at(x, y);
      if (!(cell.w > 0)) continue;
      const double residual = cell.residual(plane);
      ++known;
      if (std::abs(residual) > kOnPlane) continue;
      ++on, sum += residual;
    }
  return known > 0 && on >= kWindowShare * known && std::abs(sum) <= kWindowMean * on;
}

}  // namespace

Cells make_cells(ImageView<const float> depth_m, const geometry::Pinhole& view,
                 const NoiseParams& noise, int side_px) {
  const Size size = depth_m.size;
  Cells out{
      side_px, (size.width + side_px - 1) / side_px, (size.height + side_px - 1) / side_px, {}};
  out.cells.reserve(static_cast<std::size_t>(out.columns) * static_cast<std::size_t>(out.rows));
  for (int j = 0; j < out.rows; ++j)
    for (int i = 0; i < out.columns; ++i)
      out.cells.push_back(
          cell_of(depth_m, view, noise,
                  {i * side_px, j * side_px, std::min((i + 1) * side_px, size.width),
                   std::min((j + 1) * side_px, size.height)}));
  return out;
}

std::vector<WPlane> find_planes(const Cells& cells) {
  std::vector<const Cell*> free;
  for (const Cell& cell : cells.cells)
    if (cell.w > 0) free.push_back(&cell);
  const auto least =
      static_cast<std::ptrdiff_t>(kLeastShare * static_cast<double>(free.size())) + 6;
  const std::vector<WPlane> candidates = hypotheses(cells);
  std::vector<WPlane> planes;
  while (planes.size() < kMostPlanes) {
    const std::size_t step = std::max<std::size_t>(1, free.size() / kScoredCells);
    const WPlane* best = nullptr;
    int most = 0;
    for (const WPlane& plane : candidates) {
      int count = 0;
      for (std::size_t i = 0; i < free.size(); i += step)
        count += std::abs(free[i]->residual(plane)) <= kOnPlane ? 1 : 0;
      if (count > most) most = count, best = &plane;
    }
    if (best == nullptr) break;
    WPlane plane = *best;
    for (int round = 0; round < 3; ++round) {
      const WPlane last = plane;
      plane = fit(free, [&](const Cell& cell) {
                return std::abs(cell.residual(last)) <= kOnPlane;
              }).value_or(last);
    }
    const std::size_t before = free.size();
    std::erase_if(free,
                  [&](const Cell* cell) { return std::abs(cell->residual(plane)) <= kOnPlane; });
    if (static_cast<std::ptrdiff_t>(before - free.size()) < least) break;
    planes.push_back(plane);
  }
  return planes;
}

std::vector<PlaneSet> planes_near(const Cells& cells, const std::vector<WPlane>& planes) {
  std::vector<PlaneSet> near(cells.cells.size());
  for (int j = 0; j < cells.rows; ++j)
    for (int i = 0; i < cells.columns; ++i) {
      if (!(cells.at(i, j).w > 0)) continue;
      PlaneSet core = 0;
      for (std::size_t k = 0; k < planes.size(); ++k)
        if (is_core(cells, i, j, planes[k])) core |= static_cast<PlaneSet>(1U << k);
      if (core == 0) continue;
      for (int y = std::max(0, j - kReach); y <= std::min(cells.rows - 1, j + kReach); ++y)
        for (int x = std::max(0, i - kReach); x <= std::min(cells.columns - 1, i + kReach); ++x)
          near[static_cast<std::size_t>(y * cells.columns + x)] |= core;
    }
  return near;
}

}  // namespace mixrig::render

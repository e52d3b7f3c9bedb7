// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/room_sides.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>

namespace mixrig::touch {
namespace {

constexpr float kFoot_m = 0.08F;    ///< lower points may be of the floor
constexpr float kRim_m = 0.03F;     ///< below the top, where points may be of what lies on it
constexpr float kUpright_m = 0.1F;  ///< extent in height of a cell that holds a side
constexpr float kStanding_m = 2.0F;
constexpr int kLeastPoints = 4;
constexpr double kSeed_m = 0.2;  ///< around a cell, for a first line
constexpr std::size_t kLeastCells = 4;
constexpr double kFlat_m = 0.02;  ///< from the line
constexpr double kHole_m = 0.2, kShortest_m = 0.25;
constexpr int kRefits = 4;

/// Points of a side in one cell of the map.
struct SideCell {
  Eigen::Vector2d at_m;
  double top_m = 0;
  bool used = false;
};

std::vector<SideCell> side_cells(std::span<const plan::RoomPoint> points,
                                 const plan::FloorMap& map) {
  struct Sum {
    Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
    int points = 0;
    float low_m = 1e9F, high_m = 0;
  };
  const Size size = map.size();
  std::vector<Sum> sums(static_cast<std::size_t>(size.area()));
  for (const plan::RoomPoint& p : points) {
    const Eigen::Vector2i cell = map.cell_of(p.at_m.head<2>().cast<double>());
    const float z = p.at_m.z();
    if (!map.contains(cell) || z < kFoot_m) continue;
    if (z > std::min(kStanding_m, map.top_m.at(cell.x(), cell.y()) - kRim_m)) continue;
    Sum& sum = sums[static_cast<std::size_t>(cell.y() * size.width + cell.x())];
    sum.at_m += p.at_m.head<2>().cast<double>(), ++sum.points;
    sum.low_m = std::min(sum.low_m, z), sum.high_m = std::max(sum.high_m, z);
  }
  std::vector<SideCell> cells;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Sum& sum = sums[static_cast<std::size_t>(y * size.width + x)];
      if (sum.points >= kLeastPoints && sum.high_m - sum.low_m > kUpright_m)
        cells.push_back({sum.at_m / sum.points, double{map.top_m.at(x, y)}});
    }
  return cells;
}

struct Line {
  Eigen::Vector2d at_m, along;
  double across_m(const Eigen::Vector2d& p) const {
    return along.x() * (p.y() - at_m.y()) - along.y() * (p.x() - at_m.x());
  }
  double along_m(const Eigen::Vector2d& p) const { return along.dot(p - at_m); }
};

/// None of fewer than kLeastCells cells.
std::optional<Line> fit(const std::vector<const SideCell*>& cells) {
  if (cells.size() < kLeastCells) return std::nullopt;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const SideCell* cell : cells) mean += cell->at_m / static_cast<double>(cells.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const SideCell* cell : cells)
    scatter += (cell->at_m - mean) * (cell->at_m - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(scatter);
  return Line{mean, solver.eigenvectors().col(1)};
}

/// The cells on a line, in a run without a hole that holds the seed.
std::vector<const SideCell*> run_of(const std::vector<SideCell>& cells, const SideCell& seed,
                                    const Line& line) {
  std::vector<const SideCell*> on;
  for (const SideCell& cell : cells)
    if (!cell.used && std::abs(line.across_m(cell.at_m)) < kFlat_m) on.push_back(&cell);
  std::sort(on.begin(), on.end(), [&](const SideCell* a, const SideCell* b) {
    return line.along_m(a->at_m) < line.along_m(b->at_m);
  });
  const auto gap_m = [&](std::size_t i) {
    return line.along_m(on[i]->at_m) - line.along_m(on[i - 1]->at_m);
  };
  const double seed_m = line.along_m(seed.at_m);
  std::size_t first = 0, end = 0;
  for (std::size_t i = 0; i < on.size(); i = end) {
    for (end = i + 1; end < on.size() && gap_m(end) < kHole_m;) ++end;
    first = i;
    if (line.along_m(on[end - 1]->at_m) >= seed_m - 1e-9) break;
  }
  return {on.begin() + static_cast<std::ptrdiff_t>(first),
          on.begin() + static_cast<std::ptrdiff_t>(end)};
}

/// The run that a line through a cell and those around it grows to.
std::pair<Line, std::vector<const SideCell*>> grown_run(const std::vector<SideCell>& cells,
                                                        const SideCell& seed) {
  std::vector<const SideCell*> run;
  for (const SideCell& cell : cells)
    if (!cell.used && (cell.at_m - seed.at_m).norm() < kSeed_m) run.push_back(&cell);
  std::optional<Line> line = fit(run), last = line;
  for (int i = 0; line && i < kRefits; ++i) {
    last = line;
    run = run_of(cells, seed, *line);
    line = fit(run);
  }
  if (!line) run.clear();
  return {last.value_or(Line{}), run};
}

/// Floor that is free at 0.1 m from the line on the side of the normal.
int free_floor(const plan::FloorMap& map, const std::vector<const SideCell*>& run,
               const Eigen::Vector2d& normal) {
  int free = 0;
  for (const SideCell* cell : run)
    for (const double away_m : {0.08, 0.13}) {
      const Eigen::Vector2i at = map.cell_of(cell->at_m + away_m * normal);
      free += map.contains(at) && map.top_m.at(at.x(), at.y()) == 0 ? 1 : 0;
    }
  return free;
}

}  // namespace

std::vector<RoomSide> find_sides(std::span<const plan::RoomPoint> points,
                                 const plan::FloorMap& map) {
  std::vector<RoomSide> sides;
  std::vector<SideCell> cells = side_cells(points, map);
  for (const SideCell& seed : cells) {
    if (seed.used) continue;
    const auto [line, run] = grown_run(cells, seed);
    if (run.size() < kLeastCells) continue;
    RoomSide side{line.at_m + line.along_m(run.front()->at_m) * line.along,
                  line.at_m + line.along_m(run.back()->at_m) * line.along,
                  {-line.along.y(), line.along.x()}};
    if ((side.to_m - side.from_m).norm() < kShortest_m) continue;
    const int left = free_floor(map, run, side.normal), right = free_floor(map, run, -side.normal);
    if (left < right) side.normal = -side.normal;
    std::vector<double> tops;
    for (const SideCell* cell : run) tops.push_back(cell->top_m);
    const auto middle = tops.begin() + static_cast<std::ptrdiff_t>(tops.size() / 2);
    std::nth_element(tops.begin(), middle, tops.end());
    side.top_m = *middle;
    sides.push_back(side);
    for (const SideCell* cell : run)
      cells[static_cast<std::size_t>(cell - cells.data())].used = true;
  }
  return sides;
}

}  // namespace mixrig::touch

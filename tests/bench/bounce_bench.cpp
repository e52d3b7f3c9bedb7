// SPDX-License-Identifier: Apache-2.0
// Measures how much infrared light the surfaces of a take reflect onto each other: the reflectivity
// that explains best how large planes depart from flat (docs/results/depth_cameras.md). usage:
// bounce_bench TAKE MHZ [bent]; with `bent` a bend of second order of each plane counts as flat.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "host/capture/depth/bounce_between.h"
#include "host/capture/take/take_source.h"

namespace mixrig {
namespace {

constexpr double kTrial = 0.3;  ///< reflectivity at which the light is computed
constexpr int kMostPictures = 40, kBlocks = 10;
constexpr std::size_t kFewestCells = 40;

/// Sums of a regression of departures on added distances.
struct Slope {
  double both = 0, added = 0;
};

Slope slope_of(const depth::SeenPlane& plane, const depth::CellGrid& grid,
               const depth::CellGrid& without, int terms) {
  std::vector<std::size_t> cells;
  for (const int i : plane.cells)
    if (without.cells[static_cast<std::size_t>(i)].inverse_per_m > 0)
      cells.push_back(static_cast<std::size_t>(i));
  if (cells.size() < kFewestCells) return {};
  const auto count = static_cast<Eigen::Index>(cells.size());
  const Eigen::Vector3d u = plane.normal().unitOrthogonal(), v = plane.normal().cross(u);
  Eigen::MatrixXd shape(count, 6);
  Eigen::MatrixXd values(count, 2);
  for (Eigen::Index r = 0; r < count; ++r) {
    const Eigen::Vector3d p = grid.cells[cells[static_cast<std::size_t>(r)]].point_m();
    const Eigen::Vector3d q = without.cells[cells[static_cast<std::size_t>(r)]].point_m();
    const double a = u.dot(p), b = v.dot(p);
    shape.row(r) << 1, a, b, a * a, a * b, b * b;
    values.row(r) << plane.beyond_m(p), plane.beyond_m(p) - plane.beyond_m(q);
  }
  const Eigen::MatrixXd kept = shape.leftCols(terms);
  values -= kept * kept.colPivHouseholderQr().solve(values);
  return {values.col(0).dot(values.col(1)), values.col(1).squaredNorm()};
}

Slope slope_of(Image<float> z_m, const depth::PixelRays& rays, double modulation_hz, int terms) {
  const depth::CellGrid grid = depth::cells_of(z_m, rays);
  depth::take_out_bounce({modulation_hz, kTrial}, rays, z_m);
  const depth::CellGrid without = depth::cells_of(z_m, rays);
  Slope sum;
  for (const depth::SeenPlane& plane : depth::find_planes(grid)) {
    const Slope one = slope_of(plane, grid, without, terms);
    sum.both += one.both, sum.added += one.added;
  }
  return sum;
}

/// Reflectivity of all pictures but those of one block; of all for block kBlocks.
double reflectivity(const std::vector<Slope>& slopes, std::size_t block) {
  Slope sum;
  for (std::size_t i = 0; i < slopes.size(); ++i)
    if (i * kBlocks / slopes.size() != block)
      sum.both += slopes[i].both, sum.added += slopes[i].added;
  return kTrial * sum.both / sum.added;
}

int run(const std::string& folder, double modulation_hz, bool bent) {
  const auto source = take::open_take_source(folder);
  if (!source) return std::fprintf(stderr, "%s\n", source.error().context.c_str()), 1;
  const capture::SourceInfo& info = (*source)->info();
  const depth::PixelRays rays(info.tof);
  std::vector<Slope> slopes;
  capture::Capture frame;
  const int step = std::max(1, info.frames / kMostPictures);
  for (int number = 1; number <= info.frames; number += step) {
    if (const auto read = (*source)->read(number, frame); !read)
      return std::fprintf(stderr, "%s\n", read.error().context.c_str()), 1;
    if (info.depth_kind == capture::DepthKind::kDistance) rays.to_depth(frame.depth_m);
    slopes.push_back(slope_of(frame.depth_m, rays, modulation_hz, bent ? 6 : 3));
  }
  double squares = 0, mean = 0;
  for (std::size_t b = 0; b < kBlocks; ++b) mean += reflectivity(slopes, b) / kBlocks;
  for (std::size_t b = 0; b < kBlocks; ++b)
    squares += std::pow(reflectivity(slopes, b) - mean, 2) * (kBlocks - 1) / kBlocks;
  std::printf("%s: reflectivity %.2f, sigma %.2f, %zu pictures\n", folder.c_str(),
              reflectivity(slopes, kBlocks), std::sqrt(squares), slopes.size());
  return 0;
}

}  // namespace
}  // namespace mixrig

int main(int count, char** arguments) {
  if (count < 3) return std::fprintf(stderr, "usage: bounce_bench TAKE MHZ [bent]\n"), 2;
  return mixrig::run(arguments[1], 1e6 * std::strtod(arguments[2], nullptr), count > 3);
}

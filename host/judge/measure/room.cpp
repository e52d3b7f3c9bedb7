// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/room.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

namespace mixrig::measure {
namespace {

using Point = std::array<double, 3>;

constexpr double kOnWall_m = 0.002;
constexpr double kFree_rad = 0.5 * std::numbers::pi / 180;  ///< of wall around the end of a length

double dot_of(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point minus_of(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross_of(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Point ray_of(Size size, int x, int y) {
  const double azimuth = std::numbers::pi * (1 - 2 * (x + 0.5) / size.width);
  const double elevation = std::numbers::pi * (0.5 - (y + 0.5) / size.height);
  return {-std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
          std::sin(elevation)};
}

Point point_of(ImageView<const float> picture_m, int x, int y) {
  Point p = ray_of(picture_m.size, x, y);
  for (double& c : p) c *= picture_m.at(x, y);
  return p;
}

Point in_world(const RoomFrame& frame, const Point& p) {
  Point world = frame.origin_m;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) world[i] += frame.world_from_axes[3 * i + k] * p[k];
  return world;
}

struct Place {
  int x = 0, y = 0;
};

Place pixel_towards(const RoomFrame& frame, const Point& world, Size size) {
  const Point d = minus_of(world, frame.origin_m);
  Point p{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) p[i] += frame.world_from_axes[3 * k + i] * d[k];
  const double azimuth = std::atan2(-p[0], p[1]);
  const double elevation = std::atan2(p[2], std::hypot(p[0], p[1]));
  const double x = (1 - azimuth / std::numbers::pi) * 0.5 * size.width - 0.5;
  const double y = (0.5 - elevation / std::numbers::pi) * size.height - 0.5;
  return {(static_cast<int>(std::lround(x)) + size.width) % size.width,
          std::clamp(static_cast<int>(std::lround(y)), 0, size.height - 1)};
}

/// Whether the true surface is the wall at `at_m` in all directions around a pixel.
bool is_free_wall(ImageView<const float> true_m, const RoomFrame& frame, const Place& at,
                  std::size_t axis, double at_m) {
  const Size size = true_m.size;
  const int reach =
      std::max(1, static_cast<int>(std::ceil(kFree_rad / std::numbers::pi * size.height)));
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const int x = (at.x + dx + size.width) % size.width, y = at.y + dy;
      if (y < 0 || y >= size.height) return false;
      if (std::abs(in_world(frame, point_of(true_m, x, y))[axis] - at_m) > kOnWall_m) return false;
    }
  return true;
}

/// Mean, 95th percentile (the least error that at least 95 % do not exceed) and maximum.
WallToWall summary_of(std::vector<double>& errors_mm) {
  if (errors_mm.empty()) return {};
  std::sort(errors_mm.begin(), errors_mm.end());
  const auto count = static_cast<double>(errors_mm.size());
  const auto at95 = static_cast<std::size_t>(std::ceil(0.95 * count)) - 1;
  return {static_cast<int>(errors_mm.size()),
          std::accumulate(errors_mm.begin(), errors_mm.end(), 0.0) / count, errors_mm[at95],
          errors_mm.back()};
}

WallToWall lengths(ImageView<const float> model_m, ImageView<const float> true_m,
                   const RoomFrame& frame, std::size_t axis, int count) {
  constexpr int kTriesPerLength = 400;
  std::mt19937_64 random(axis + 1);
  const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<double> errors_mm;
  for (int tries = kTriesPerLength * count; tries > 0 && std::ssize(errors_mm) < count; --tries) {
    Point ends{};
    for (std::size_t k = 0; k < 3; ++k) ends[k] = share() * frame.inner_m[k];
    double measured_m = 0, actual_m = 0;
    bool free = true;
    for (const double end : {0.0, 1.0}) {
      ends[axis] = end * frame.inner_m[axis];
      const Place at = pixel_towards(frame, ends, model_m.size);
      const double actual = in_world(frame, point_of(true_m, at.x, at.y))[axis];
      free =
          free && model_m.at(at.x, at.y) > 0 && is_free_wall(true_m, frame, at, axis, ends[axis]);
      const double sign = 2 * end - 1;
      measured_m += sign * in_world(frame, point_of(model_m, at.x, at.y))[axis];
      actual_m += sign * actual;
    }
    if (free) errors_mm.push_back(1000 * std::abs(measured_m - actual_m));
  }
  return summary_of(errors_mm);
}

/// Distance of the model's point to the plane of the true surface at the same pixel.
double off_surface_m(ImageView<const float> model_m, ImageView<const float> true_m, int x, int y) {
  const int right = (x + 1) % true_m.size.width, below = std::min(y + 1, true_m.size.height - 1);
  const Point here = point_of(true_m, x, y);
  const Point normal = cross_of(minus_of(point_of(true_m, right, y), here),
                                minus_of(point_of(true_m, x, below), here));
  const double length = std::sqrt(dot_of(normal, normal));
  const double off_m = static_cast<double>(model_m.at(x, y)) - true_m.at(x, y);
  if (length < 1e-12) return std::abs(off_m);
  return std::abs(off_m * dot_of(ray_of(true_m.size, x, y), normal)) / length;
}

struct Weighted {
  double value = 0, weight = 0;
};

/// The least value up to which the weights add up to `weight`; 0 of nothing.
double quantile_of(const std::vector<Weighted>& sorted, double weight) {
  double sum = 0;
  for (const Weighted& w : sorted) {
    sum += w.weight;
    if (sum >= weight) return w.value;
  }
  return sorted.empty() ? 0 : sorted.back().value;
}

}  // namespace

Image<float> off_surface_mm(ImageView<const float> model_m, ImageView<const float> true_m) {
  Image<float> off_mm(model_m.size, -1.0F);
  for (int y = 0; y + 1 < model_m.size.height; ++y)
    for (int x = 0; x < model_m.size.width; ++x)
      if (model_m.at(x, y) > 0 && true_m.at(x, y) > 0)
        off_mm.row(y)[x] = static_cast<float>(1000 * off_surface_m(model_m, true_m, x, y));
  return off_mm;
}

RoomErrors room_errors(ImageView<const float> model_m, ImageView<const float> true_m,
                       const RoomFrame& frame, int count) {
  RoomErrors errors;
  for (std::size_t axis = 0; axis < 3; ++axis)
    errors.axes[axis] = lengths(model_m, true_m, frame, axis, count);
  const Image<float> off_mm = off_surface_mm(model_m, true_m);
  std::vector<Weighted> known;
  double all = 0, over = 0;
  for (int y = 0; y + 1 < model_m.size.height; ++y)
    for (int x = 0; x < model_m.size.width; ++x) {
      const auto mm = static_cast<double>(off_mm.row(y)[x]);
      if (mm < 0) continue;
      const double solid = std::sin(std::numbers::pi * (y + 0.5) / model_m.size.height);
      all += solid, over += mm > 20 ? solid : 0;
      known.push_back({mm, solid});
    }
  errors.points = known.size();
  std::sort(known.begin(), known.end(),
            [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  errors.p50_mm = quantile_of(known, 0.5 * all);
  errors.p95_mm = quantile_of(known, 0.95 * all);
  errors.over_20mm_pct = all > 0 ? 100 * over / all : 0;
  return errors;
}

}  // namespace mixrig::measure

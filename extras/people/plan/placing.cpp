// SPDX-License-Identifier: Apache-2.0
// Finds places for a virtual object where nobody walks through it.
#include "extras/people/plan/placing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mixrig::plan {
namespace {

constexpr int kSamples = 6;         ///< along a side of the box
constexpr float kBehind_m = 0.05F;  ///< what is nearer than the room's surface is seen
constexpr double kNoPath_m = 100;
constexpr double kLookAround_m = 1;
constexpr double kShadowWeight = 0.02, kPathWeight = 0.02;  ///< in the score, at most

Eigen::Rotation2Dd turned(double yaw_rad) { return Eigen::Rotation2Dd(yaw_rad); }

/// Whether each point of the footprint lies in an open cell.
bool fits(const FloorMap& map, const Image<std::uint8_t>& blocked, const Footprint& box,
          const Eigen::Vector2d& at_m, double yaw_rad) {
  const auto steps = [&](double length_m) {
    return std::max(1, static_cast<int>(std::ceil(length_m / map.cell_m)));
  };
  const int nx = steps(box.size_m.x()), ny = steps(box.size_m.y());
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const Eigen::Vector2d p = box.size_m.cwiseProduct(
          Eigen::Vector2d(static_cast<double>(i) / nx - 0.5, static_cast<double>(j) / ny - 0.5));
      const Eigen::Vector2i cell = map.cell_of(at_m + turned(yaw_rad) * p);
      if (!map.contains(cell) || blocked.at(cell.x(), cell.y()) != 0) return false;
    }
  return true;
}

bool is_seen(const Eigen::Vector3d& world_m, const RoomView& view) {
  const Eigen::Vector3d p = geometry::inverse(view.world_from_view) * world_m;
  if (p.z() <= 0.1) return false;
  const Eigen::Vector2d px = view.view.project(p);
  const int x = static_cast<int>(std::lround(px.x())), y = static_cast<int>(std::lround(px.y()));
  if (x < 0 || y < 0 || x >= view.depth_m.size.width || y >= view.depth_m.size.height) return false;
  const float z = view.depth_m.at(x, y);
  return z <= 0 || static_cast<float>(p.z()) < z + kBehind_m;
}

/// Share on free floor of the shadow's line, which runs from the base of the box to where the light
/// over its top edge meets the floor.
double shadow_share(const FloorMap& map, const Footprint& box, const Eigen::Vector2d& at_m,
                    const Eigen::Vector3d& lamp_m) {
  if (lamp_m.z() <= box.height_m) return 0;
  const Eigen::Vector2d tip =
      at_m + (at_m - lamp_m.head<2>()) * (box.height_m / (lamp_m.z() - box.height_m));
  const int steps = std::max(1, static_cast<int>((tip - at_m).norm() / map.cell_m));
  int free = 0;
  for (int i = 1; i <= steps; ++i) {
    const Eigen::Vector2i cell = map.cell_of(at_m + (tip - at_m) * i / steps);
    free += map.contains(cell) && map.top_m.at(cell.x(), cell.y()) == 0 ? 1 : 0;
  }
  return static_cast<double>(free) / steps;
}

double nearest_thing_m(const FloorMap& map, const Eigen::Vector2d& at_m) {
  const int reach = static_cast<int>(kLookAround_m / map.cell_m);
  const Eigen::Vector2i middle = map.cell_of(at_m);
  double least_m = kLookAround_m;
  for (int j = -reach; j <= reach; ++j)
    for (int i = -reach; i <= reach; ++i) {
      const Eigen::Vector2i cell = middle + Eigen::Vector2i(i, j);
      if (map.contains(cell) && map.top_m.at(cell.x(), cell.y()) > 0)
        least_m = std::min(least_m, map.cell_m * std::hypot(i, j));
    }
  return least_m;
}

double nearest_path_m(std::span<const Eigen::Vector2d> paths_m, const Eigen::Vector2d& at_m) {
  double least_m = kNoPath_m;
  for (const Eigen::Vector2d& p : paths_m) least_m = std::min(least_m, (p - at_m).norm());
  return least_m;
}

/// Mask of the cells in which no part of a box may be.
Image<std::uint8_t> blocked_by(const FloorMap& map, std::span<const Eigen::Vector2d> paths_m,
                               const PlacingOptions& options) {
  // Things in a cell, and the box, may lie half a cell farther than its middle.
  const auto reach = [&](double distance_m) {
    return distance_m / map.cell_m + std::numbers::sqrt2;
  };
  Image<std::uint8_t> blocked = grown(not_free(map), reach(options.margin_m));
  Image<std::uint8_t> walked(map.size());
  for (const Eigen::Vector2d& p : paths_m)
    if (const Eigen::Vector2i cell = map.cell_of(p); map.contains(cell))
      walked.at(cell.x(), cell.y()) = 255;
  walked = grown(walked, reach(options.path_margin_m));
  for (int y = 0; y < map.size().height; ++y)
    for (int x = 0; x < map.size().width; ++x) blocked.at(x, y) |= walked.at(x, y);
  return blocked;
}

}  // namespace

double visible_share(const Footprint& box, const Eigen::Vector2d& at_m, double yaw_rad,
                     const RoomView& view) {
  const Eigen::Vector3d half(box.size_m.x() / 2, box.size_m.y() / 2, box.height_m / 2);
  const Eigen::Vector3d middle(at_m.x(), at_m.y(), half.z());
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  axes.topLeftCorner<2, 2>() = turned(yaw_rad).toRotationMatrix();
  double seen_m2 = 0, all_m2 = 0;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? 1 : -1;
    const Eigen::Vector3d normal = sign * axes.col(axis);
    const Eigen::Vector3d face = middle + half[axis] * normal;
    if (normal.dot(view.world_from_view.translation_m - face) <= 0) continue;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double sample_m2 = 4 * half[u] * half[v] / (kSamples * kSamples);
    for (int j = 0; j < kSamples; ++j)
      for (int i = 0; i < kSamples; ++i) {
        const Eigen::Vector3d p = face + half[u] * ((2 * i + 1.0) / kSamples - 1) * axes.col(u) +
                                  half[v] * ((2 * j + 1.0) / kSamples - 1) * axes.col(v);
        all_m2 += sample_m2;
        seen_m2 += is_seen(p, view) ? sample_m2 : 0;
      }
  }
  return all_m2 > 0 ? seen_m2 / all_m2 : 0;
}

std::vector<FreePlace> suggest_places(const FloorMap& map, std::span<const Eigen::Vector2d> paths_m,
                                      const Footprint& box, const RoomView& view, int count,
                                      const PlacingOptions& options) {
  const Image<std::uint8_t> blocked = blocked_by(map, paths_m, options);
  std::vector<FreePlace> places;
  const double width_m = map.size().width * map.cell_m, depth_m = map.size().height * map.cell_m;
  for (double y = 0; y < depth_m; y += options.step_m)
    for (double x = 0; x < width_m; x += options.step_m) {
      FreePlace best;
      best.at_m = map.corner_m + Eigen::Vector2d(x, y);
      best.visible_share = -1;
      for (int turn = 0; turn < options.turns; ++turn) {
        const double yaw_rad = std::numbers::pi * turn / options.turns;
        if (!fits(map, blocked, box, best.at_m, yaw_rad)) continue;
        const double share = visible_share(box, best.at_m, yaw_rad, view);
        if (share > best.visible_share) best.visible_share = share, best.yaw_rad = yaw_rad;
      }
      if (best.visible_share <= 0) continue;
      best.path_m = nearest_path_m(paths_m, best.at_m);
      best.room_m = nearest_thing_m(map, best.at_m);
      best.shadow_share = options.lamp_m ? shadow_share(map, box, best.at_m, *options.lamp_m) : 1.0;
      best.score = best.visible_share + kShadowWeight * best.shadow_share +
                   kPathWeight * std::min(1.0, best.path_m);
      places.push_back(best);
    }
  std::stable_sort(places.begin(), places.end(),
                   [](const FreePlace& a, const FreePlace& b) { return a.score > b.score; });
  std::vector<FreePlace> chosen;
  for (const FreePlace& p : places) {
    if (static_cast<int>(chosen.size()) == count) break;
    const bool apart = std::all_of(chosen.begin(), chosen.end(), [&](const FreePlace& other) {
      return (other.at_m - p.at_m).norm() >= options.apart_m;
    });
    if (apart) chosen.push_back(p);
  }
  return chosen;
}

}  // namespace mixrig::plan

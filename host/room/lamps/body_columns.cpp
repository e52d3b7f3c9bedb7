// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/body_columns.h"

#include <algorithm>
#include <cmath>

namespace mixrig::lights {
namespace {

std::pair<int, int> cell_of(const Eigen::Vector3d& p) {
  return {static_cast<int>(std::floor(p.x() / BodyColumns::kCell_m)),
          static_cast<int>(std::floor(p.y() / BodyColumns::kCell_m))};
}

}  // namespace

BodyColumns::BodyColumns(std::span<const Eigen::Vector3d> people_m) {
  for (const Eigen::Vector3d& p : people_m) {
    const auto [x, y] = cell_of(p);
    for (int j = y - 1; j <= y + 1; ++j)
      for (int i = x - 1; i <= x + 1; ++i) {
        const auto [at, is_new] = top_m_.try_emplace({i, j}, p.z());
        if (!is_new) at->second = std::max(at->second, p.z());
      }
  }
}

bool BodyColumns::hides(const Eigen::Vector3d& lamp_m, const Eigen::Vector3d& place_m) const {
  if (top_m_.empty()) return false;
  const Eigen::Vector3d way_m = lamp_m - place_m;
  const int steps = 1 + static_cast<int>(2 * way_m.head<2>().norm() / kCell_m);
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector3d at_m = place_m + static_cast<double>(i) / steps * way_m;
    const auto column = top_m_.find(cell_of(at_m));
    if (column != top_m_.end() && at_m.z() < column->second) return true;
  }
  return false;
}

}  // namespace mixrig::lights

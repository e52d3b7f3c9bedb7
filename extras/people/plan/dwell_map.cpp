// SPDX-License-Identifier: Apache-2.0
// Sums the time that people spent in each place of the floor.
#include "extras/people/plan/dwell_map.h"

#include <Eigen/Geometry>

namespace mixrig::plan {

void DwellMap::add(const Eigen::Vector2d& at_m, double time_s) {
  const Eigen::Vector2i cell = (at_m / kCell_m).array().floor().cast<int>();
  time_s_[{cell.x(), cell.y()}] += time_s;
}

DwellGrid DwellMap::grid() const {
  DwellGrid grid{kCell_m, Eigen::Vector2d::Zero(), {}};
  if (time_s_.empty()) return grid;
  Eigen::AlignedBox2i box;
  for (const auto& [cell, time_s] : time_s_) box.extend(Eigen::Vector2i(cell[0], cell[1]));
  grid.corner_m = kCell_m * box.min().cast<double>();
  grid.time_s.reset({box.sizes().x() + 1, box.sizes().y() + 1});
  for (int y = 0; y < grid.time_s.height(); ++y)
    for (int x = 0; x < grid.time_s.width(); ++x) grid.time_s.at(x, y) = 0;
  for (const auto& [cell, time_s] : time_s_)
    grid.time_s.at(cell[0] - box.min().x(), cell[1] - box.min().y()) = static_cast<float>(time_s);
  return grid;
}

}  // namespace mixrig::plan

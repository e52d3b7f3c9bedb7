// SPDX-License-Identifier: Apache-2.0
// Sums the time that people spent in each place of the floor.
#pragma once

#include <array>
#include <map>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::plan {

/// Grid of the floor; column x and row y hold the world's x and y from the corner on.
struct DwellGrid {
  double cell_m = 0;
  Eigen::Vector2d corner_m = Eigen::Vector2d::Zero();
  Image<float> time_s;  ///< of all people together; empty where nobody was
};

/// Sums the time that people spent in each cell of the floor. One thread.
class DwellMap {
 public:
  static constexpr double kCell_m = 0.1;
  /// Adds a person who was at a place for `time_s`.
  void add(const Eigen::Vector2d& at_m, double time_s);
  /// Smallest grid that holds all cells.
  DwellGrid grid() const;

 private:
  std::map<std::array<int, 2>, double> time_s_;  ///< by the cell's x and y, in cells
};

}  // namespace mixrig::plan

// SPDX-License-Identifier: Apache-2.0
// Models what people hide of lamps: columns over a grid of the floor, below their visible surface.
#pragma once

#include <map>
#include <span>
#include <utility>

#include <Eigen/Core>

namespace mixrig::lights {

/// Columns in world axes, z up. Each reaches down without end from the highest point of people in
/// its cell and the neighbouring cells, since people's far side is not seen.
class BodyColumns {
 public:
  static constexpr double kCell_m = 0.2;
  /// `people_m`: points of people's visible surface.
  explicit BodyColumns(std::span<const Eigen::Vector3d> people_m);
  /// Whether a column stands between a lamp and a place below it.
  bool hides(const Eigen::Vector3d& lamp_m, const Eigen::Vector3d& place_m) const;

 private:
  std::map<std::pair<int, int>, double> top_m_;  ///< highest point by cell
};

}  // namespace mixrig::lights

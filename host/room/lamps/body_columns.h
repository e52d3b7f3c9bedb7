// SPDX-License-Identifier: Apache-2.0
// What people can hide of lamps: columns over a grid of the floor, under the surface that is seen
// of them.
#pragma once

#include <map>
#include <span>
#include <utility>

#include <Eigen/Core>

namespace mixrig::lights {

/// World axes, z up. A column reaches from below everything to the highest point of people in its
/// cell and in those next to it: their far side is not seen.
class BodyColumns {
 public:
  static constexpr double kCell_m = 0.2;
  /// Points of people's seen surface.
  explicit BodyColumns(std::span<const Eigen::Vector3d> people_m);
  /// Whether a column stands between a lamp and a place below it.
  bool hides(const Eigen::Vector3d& lamp_m, const Eigen::Vector3d& place_m) const;

 private:
  std::map<std::pair<int, int>, double> top_m_;  ///< by cell
};

}  // namespace mixrig::lights

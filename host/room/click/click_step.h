// SPDX-License-Identifier: Apache-2.0
// Finds steps between parallel planes that are smaller than the noise of one depth.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace mixrig::model {

/// Signed distance of a pixel from a plane.
struct PlaceOff {
  Eigen::Vector2d px;
  double sigmas = 0;  ///< in sigmas of one depth
};

/// A line across the picture with the click on one side; pixels with px . normal > at_px are beyond
/// it.
struct StepLine {
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();
  double at_px = 0;
  double contrast = 0;  ///< difference of the means of both sides, in its sigmas

  bool is_beyond(const Eigen::Vector2d& px) const { return normal.dot(px) > at_px; }
};

/// Finds straight steps between the click and other places: a picture on a wall, a board on a
/// table, their corners. Among the lines that split the places, with those nearest to the click
/// like the rest of their side, the line with the largest difference of means for its noise is
/// taken. It is a step if that exceeds chance over all such lines (kStepSigmas) and what depths
/// have in common (kLeastStep); then the remaining places are searched again, up to four times.
/// Pure; sorts at most 4096 places (every n-th of more) 16 times for each step.
std::vector<StepLine> find_steps(std::span<const PlaceOff> places, const Eigen::Vector2d& click_px);

}  // namespace mixrig::model

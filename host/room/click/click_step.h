// SPDX-License-Identifier: Apache-2.0
// Steps between parallel planes that are smaller than the noise of one depth.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace mixrig::model {

/// How far a place of the picture is off a plane.
struct PlaceOff {
  Eigen::Vector2d px;
  double sigmas = 0;  ///< of one depth
};

/// A line across the picture with the click on one side; px . normal > at_px is beyond it.
struct StepLine {
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();
  double at_px = 0;
  double contrast = 0;  ///< of the means of both sides, in sigmas of their difference

  bool is_beyond(const Eigen::Vector2d& px) const { return normal.dot(px) > at_px; }
};

/// Straight steps between the click and other places: a picture on a wall, a board on a table,
/// their corners. Of the lines that part the places in two, so that those nearest to the click are
/// off as their side is and not as the other one, that counts whose sides differ most for their
/// noise. It is a step where this is more than chance among all such lines (kStepSigmas) and more
/// than what depths have in common (kLeastStep); then the rest is asked again, up to four times.
/// Pure; 16 sorts of at most 4096 places (of more, each n-th is looked at) for each step.
std::vector<StepLine> find_steps(std::span<const PlaceOff> places, const Eigen::Vector2d& click_px);

}  // namespace mixrig::model

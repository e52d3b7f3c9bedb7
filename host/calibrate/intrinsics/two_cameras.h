// SPDX-License-Identifier: Apache-2.0
// Are the views of one camera, or of two that were mixed? Private to this module.
#pragma once

#include <optional>
#include <vector>

#include "host/calibrate/intrinsics/bundle.h"

namespace mixrig::calibration {

/// Two groups of views, each with a camera of its own.
struct TwoCameras {
  std::vector<char> second;  ///< 1 for each view of the second group, else 0
  double sigma_px = 0;       ///< noise of one coordinate by the residuals of both groups
  double own_px = 0;    ///< root mean square residual of all points, under their group's camera
  double other_px = 0;  ///< that under the other group's camera, poses fitted anew
};

/// Finds the best partition of the views into two groups of kFewestViews views or more, by k-means
/// with cameras as means, from a few starts. nullopt where none is found. `solved`: the bundle of
/// all views with one camera.
std::optional<TwoCameras> split_in_two(const Bundle& solved);

/// Whether the split explains the views so much better than one camera with residuals of `sigma_px`
/// that they must be of two.
bool tells_apart(const TwoCameras& split, double sigma_px);

}  // namespace mixrig::calibration

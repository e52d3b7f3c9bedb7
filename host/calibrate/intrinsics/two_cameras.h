// SPDX-License-Identifier: Apache-2.0
// Are the views of one camera, or of two that were mixed? Private to this module.
#pragma once

#include <optional>
#include <vector>

#include "host/calibrate/intrinsics/bundle.h"

namespace mixrig::calibration {

/// Two groups of views, each with a camera of its own.
struct TwoCameras {
  std::vector<char> second;  ///< a view: 1 if it is of the second group
  double sigma_px = 0;       ///< noise of one coordinate by the residuals of both groups
  double own_px = 0;         ///< root mean square distance under the own camera
  double other_px = 0;       ///< under the other group's, poses fitted anew
};

/// The best partition found into two groups of kFewestViews views or more (k-means with cameras for
/// means, from a few starts); nullopt where none is found. `solved` by one camera.
std::optional<TwoCameras> split_in_two(const Bundle& solved);

/// Whether the split explains the views so much better than one camera with residuals of `sigma_px`
/// that they must be of two.
bool tells_apart(const TwoCameras& split, double sigma_px);

}  // namespace mixrig::calibration

// SPDX-License-Identifier: Apache-2.0
// Finds how much brighter or darker the views of a sweep are, where they overlap. The camera may
// change its exposure or white balance between views, and its lens darkens the corners.
#pragma once

#include <span>
#include <vector>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Compares the colours of the views that see the same surface (within depth and its sigma) in
/// places without texture, saturation or darkness. For the linear colour c of a place in view i, at
/// distance r from the principal point over half the picture's diagonal, it minimises the
/// differences of log c + gain_i + a r^2 + b r^4 between views by robust least squares. (Goldman
/// and Chen 2005 name the ambiguities; here light is linear and vignetting radial.) The mean of all
/// gains stays 1. A third of the places is held out: unless these agree better by a twentieth,
/// nothing is corrected.
/// `panorama` needs distances and views.
ViewGains find_gains(std::span<const ScanView> views, const geometry::CameraModel& tof,
                     const geometry::CameraModel& target, const Panorama& panorama, Crew& crew);

}  // namespace mixrig::model

// SPDX-License-Identifier: Apache-2.0
// Finds gains and a vignetting that make the views of a sweep equally bright where they overlap:
// the camera may change its exposure or white balance between views, and its lens darkens corners.
#pragma once

#include <span>
#include <vector>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Compares the colours of the views that see the same surface (within depth and its sigma) in
/// places without texture, saturation or darkness. For the linear colour c of a place in view i, at
/// distance r from the principal point over half the picture's diagonal, it minimises the
/// differences of log c + gain_i + a r^2 + b r^4 between views by robust least squares. (Goldman
/// and Chen 2005 name the ambiguities; here light is linear, and vignetting has even powers of r
/// alone.) The geometric mean of all gains stays 1. A third of the places is held out: unless these
/// agree better by a twentieth, there are no gains.
/// `panorama` needs distances and views.
ViewGains find_gains(std::span<const ScanView> views, const geometry::CameraModel& tof,
                     const geometry::CameraModel& target, const Panorama& panorama, Crew& crew);

}  // namespace mixrig::model

// SPDX-License-Identifier: Apache-2.0
// Views of a sweep whose pictures are not equally bright: the camera changed its exposure or white
// balance between them, and its lens darkens the corners. Found where views overlap.
#pragma once

#include <span>
#include <vector>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Compares the colours of the views that see the same surface (within depth and its sigma) in
/// places without texture, saturation or darkness. With c the linear colour of one place in view i,
/// r its distance from the principal point over half the picture's diagonal, log c + gain_i + a r^2
/// + b r^4 has to be the same in all views (Goldman and Chen 2005 name the ambiguities; here light
/// is linear and vignetting even), in the least squares of robust weights. The mean of all gains
/// stays 1. A third of the places is held out: where these do not agree better by a twentieth, all
/// stays as it is.
/// `panorama` needs distances and views.
ViewGains find_gains(std::span<const ScanView> views, const geometry::CameraModel& tof,
                     const geometry::CameraModel& target, const Panorama& panorama, Crew& crew);

}  // namespace mixrig::model

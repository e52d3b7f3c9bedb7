// SPDX-License-Identifier: Apache-2.0
// Lens of one camera and the board's poses, from its corners alone.
#pragma once

#include "host/calibrate/rig/rig_start.h"

namespace mixrig::calibration {

/// Pose of the board from corners (IPPE of Collins and Bartoli 2014 on the rays less than 80
/// degrees off the axis); of two solutions the one that fits better. False where there are less
/// than 6.
bool pose_of_corners(const RigCamera& camera, double square_m,
                     const std::vector<SeenCorner>& corners, geometry::Pose& camera_from_board);

/// Solves one camera alone. Removes views and corners that no lens explains from `data` and counts
/// them there. Errors: kData where no lens explains half of the views.
Result<RigModel> solve_lens(RigData& data, std::size_t camera, Crew& crew);

}  // namespace mixrig::calibration

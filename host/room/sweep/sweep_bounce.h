// SPDX-License-Identifier: Apache-2.0
// Light that walls throw on each other, taken out of the views of a sweep.
#pragma once

#include <vector>

#include "host/capture/capture/rig_cameras.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::session {

/// What was found of the bounced light, and whether it was taken out.
struct BouncedRoomLight {
  bool removed = false;
  double reflectivity = 0;             ///< of the room in the infrared, 0 to 1
  std::size_t corners = 0;             ///< seen in all views, before
  double before_mm = 0, after_mm = 0;  ///< mean error beside corners (depth::corner_error)
};

/// Finds the room's reflectivity by the corners in the views and takes one reflection out of their
/// distances. The views stay as they are where the corners do not determine the reflectivity, or
/// where its light does not lower the error beside them.
BouncedRoomLight take_out_bounced_light(const geometry::CameraModel& tof, double modulation_hz,
                                        std::vector<model::ScanView>& views, Crew& crew);

}  // namespace mixrig::session

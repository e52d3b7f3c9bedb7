// SPDX-License-Identifier: Apache-2.0
// Positions of furniture, person, object and camera in each scenario, and the camera's motion.
#pragma once

#include "host/studio/stage/posture.h"
#include "host/studio/stage/room.h"
#include "host/studio/studio.h"

namespace mixrig::studio {

struct Layout {
  RoomPlan room;
  Stage stage;
  geometry::Pose world_from_object;
  Eigen::Vector3d eye_m, look_at_m;
  Light light;
  bool camera_moves = false;
};

/// One step of the pan-tilt unit, 0.0514 degrees.
inline constexpr double kPanStep_rad = 0.0514 * 3.14159265358979323846 / 180;

struct CameraPlace {
  geometry::Pose world_from_target;
  double pan_rad = 0, tilt_rad = 0;
};

Layout make_layout(const StudioOptions& options);
CameraPlace camera_at(const Layout& layout, const StudioOptions& options, double time_s);

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// Positions of furniture, person, object and camera in each scenario, and the camera's motion.
#pragma once

#include "studio/pan_tilt_unit.h"
#include "studio/stage/posture.h"
#include "studio/stage/room.h"
#include "studio/studio.h"

namespace mixrig::studio {

struct Layout {
  RoomPlan room;
  Stage stage;
  geometry::Pose world_from_object;
  Eigen::Vector3d eye_m, look_at_m;
  PanTiltUnit pan_tilt;
  Light light;
  bool camera_moves = false;
};

struct CameraPlace {
  geometry::Pose world_from_target;
  std::optional<HeadAngles> head =
      std::nullopt;  ///< of the encoders, in scenarios pan, shot and sweep
};

/// Frames at the start of a take without people.
int empty_frames(const StudioOptions& options);
/// Share of the ambient light at a level of the lamps, relative to level 1.
float ambient_share(float lamp_level);
/// Opening angle of the door; 0: closed.
float door_rad(const Day& day, double time_s);
Layout make_layout(const StudioOptions& options);
/// World pose of the target camera at rest; of a pan-tilt unit, at angles zero.
geometry::Pose rest_pose(const Layout& layout);
/// Box that holds the person at all times of the take, and no furniture if the floor is clear.
Volume capture_volume(const Layout& layout);
/// Camera pose `time_s` after the first frame; continuous, also between frames.
CameraPlace camera_at(const Layout& layout, const StudioOptions& options, double time_s);

}  // namespace mixrig::studio

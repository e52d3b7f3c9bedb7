// SPDX-License-Identifier: Apache-2.0
// Intersects the ray of sight through a place in the picture with the room's surface, or with a
// level.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "hal/base/result.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/pose.h"
#include "host/room/click/clicked_plane.h"

namespace mixrig::session {

struct Session;

/// View and pose of the last frame.
struct SeenFrom {
  geometry::Pose world_from_view;
  geometry::Pinhole view;
};

/// Point of a horizontal level at a place in the picture (0..1 of width and height). `level_m`:
/// height of the level in the world. Errors: kData where the ray of sight does not reach it within
/// 100 m.
Result<Eigen::Vector3d> point_on_level(const SeenFrom& from, const Eigen::Vector2d& at,
                                       double level_m);
/// Place of a world point in the picture, 0..1; nullopt behind the camera or outside.
std::optional<Eigen::Vector2d> place_in_picture(const SeenFrom& from,
                                                const Eigen::Vector3d& p_world);

/// Point of the empty room at a place in the picture, by the background that the session began
/// with. Where its depth is unknown (a lamp blinds the depth camera), the depth of the nearest
/// known pixel within 20 px is used. Takes some tens of milliseconds. Errors: kUnsupported where
/// the session has no background, kData where no surface is known there.
Result<Eigen::Vector3d> point_on_room(const Session& session, const SeenFrom& from,
                                      const Eigen::Vector2d& at);

/// Plane of the empty room at a place in the picture, by the background that the session began
/// with, at the depth camera's resolution. Takes as long as one point_on_room() for all its pixels.
/// Errors: kUnsupported where the session has no background, kData where there is no plane, with
/// the reason.
Result<model::ClickedPlane> plane_on_room(const Session& session, const SeenFrom& from,
                                          const Eigen::Vector2d& at);

}  // namespace mixrig::session

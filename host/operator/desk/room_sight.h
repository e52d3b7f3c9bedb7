// SPDX-License-Identifier: Apache-2.0
// Intersects the sight through a place in the picture with the room's surface, or with a level.
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

/// The point of a horizontal level that is seen at a place in the picture (0..1 of width and
/// height). Errors: kData where the sight does not reach it within 100 m.
Result<Eigen::Vector3d> point_on_level(const SeenFrom& from, const Eigen::Vector2d& at,
                                       double level_m);
/// Place of a world point in the picture, 0..1; nullopt behind the camera or outside.
std::optional<Eigen::Vector2d> place_in_picture(const SeenFrom& from,
                                                const Eigen::Vector3d& p_world);

/// The point of the empty room that is seen at a place in the picture, by the background that the
/// session began with. Where its depth is not known (a lamp blinds the depth camera) that of the
/// nearest pixel within 20 px is used. Takes some tens of milliseconds. Errors: kUnsupported where
/// the session has no background, kData where no surface is known there.
Result<Eigen::Vector3d> point_on_room(const Session& session, const SeenFrom& from,
                                      const Eigen::Vector2d& at);

/// The plane of the empty room under a place in the picture, by the same background at the depth
/// camera's resolution. Takes as long as point_on_room() for each of its pixels once. Errors:
/// kUnsupported where the session has no background, kData where no plane is there, saying why.
Result<model::ClickedPlane> plane_on_room(const Session& session, const SeenFrom& from,
                                          const Eigen::Vector2d& at);

}  // namespace mixrig::session

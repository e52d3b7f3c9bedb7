// SPDX-License-Identifier: Apache-2.0
// An object of a scene set on the surface under a pixel.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "host/room/click/clicked_plane.h"
#include "host/run/session/session.h"

namespace mixrig::session {

struct PlaceOptions {
  SessionOptions session;
  int frame = 1;                  ///< whose depth is looked at
  model::Click click;             ///< pixels of the view
  std::string object;             ///< empty: the scene's only one
  double turn_rad = 0;            ///< about the normal, counter-clockwise seen from its tip
  Eigen::Vector2d slide_m{0, 0};  ///< in the plane: to the right, and away from the camera
                                  ///< (on a wall: up)
  std::filesystem::path drawing;  ///< PNG of the plate with the plane; empty: none
};

struct Placement {
  std::string object;
  model::ClickedPlane plane;  ///< axes of the view
  geometry::Pose world_from_view;
  geometry::Pose world_from_object;
};

/// Axes of what stands on a plane: z along `normal`; y away from the eye (on a plane steeper than
/// 45 degrees: up), turned about z by `turn_rad`. World axes. Pure.
Eigen::Quaterniond rotation_on_plane(const Eigen::Vector3d& normal, const Eigen::Vector3d& sight,
                                     double turn_rad);

/// Of an object whose lowest vertex lies on the plane, its origin above the click; turned and slid
/// as PlaceOptions say. World axes. Pure.
geometry::Pose pose_on_plane(const scene::Object& object, const model::ClickedPlane& plane,
                             const geometry::Pose& world_from_view, double turn_rad,
                             const Eigen::Vector2d& slide_m);

/// The object as pose_on_plane() has it. Errors: those of
/// the session; kUsage for an object that is not there; kData where the plane is refused, saying
/// why, and where the frame has no pose.
Result<Placement> place_object(const PlaceOptions& options);

/// {"object", "position_m", "rotation_xyzw", "normal", "normal_sigma_deg", "offset_sigma_mm",
/// "residual", "points", "area_m2"}, world axes.
nlohmann::json to_json(const Placement& placement);

/// Writes the object's pose into the scene; its other text stays. Errors: those of reading,
/// scene::with_object_pose(), kIo.
Result<void> write_placement(const Placement& placement, const std::filesystem::path& scene);

}  // namespace mixrig::session

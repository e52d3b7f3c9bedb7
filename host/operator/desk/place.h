// SPDX-License-Identifier: Apache-2.0
// Sets an object of a scene on the surface under a pixel.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "host/room/click/clicked_plane.h"
#include "host/run/session/session.h"

namespace mixrig::session {

struct PlaceOptions {
  SessionOptions session;
  int frame = 1;        ///< frame whose depth is used
  model::Click click;   ///< pixels of the view
  std::string object;   ///< empty: the only object of the scene
  double turn_rad = 0;  ///< about the normal, counter-clockwise seen from its tip
  /// Shift in the plane: to the right, and away from the camera (on a plane steeper than 45
  /// degrees: up).
  Eigen::Vector2d slide_m{0, 0};
  std::filesystem::path drawing;  ///< PNG of the plate with the plane; empty: none
};

struct Placement {
  std::string object;
  model::ClickedPlane plane;  ///< axes of the view
  geometry::Pose world_from_view;
  geometry::Pose world_from_object;
};

/// Rotation of an object that stands on a plane: z along `normal`; y away from the camera (on a
/// plane steeper than 45 degrees: up), turned about z by `turn_rad`. `sight`: direction of view.
/// World axes. Pure.
Eigen::Quaterniond rotation_on_plane(const Eigen::Vector3d& normal, const Eigen::Vector3d& sight,
                                     double turn_rad);

/// Pose of an object whose lowest vertex lies on the plane and whose origin is above the click,
/// turned and shifted as PlaceOptions say. World axes. Pure.
geometry::Pose pose_on_plane(const scene::Object& object, const model::ClickedPlane& plane,
                             const geometry::Pose& world_from_view, double turn_rad,
                             const Eigen::Vector2d& slide_m);

/// Places the object by pose_on_plane(). Errors: those of the session; kUsage for an object that
/// does not exist; kData where no plane is found, with the reason, and where the frame has no pose.
Result<Placement> place_object(const PlaceOptions& options);

/// {"object", "position_m", "rotation_xyzw", "normal", "normal_sigma_deg", "offset_sigma_mm",
/// "residual", "points", "area_m2"}, world axes.
nlohmann::json to_json(const Placement& placement);

/// Writes the object's pose into the scene; its other text stays. Errors: those of reading,
/// scene::with_object_pose(), kIo.
Result<void> write_placement(const Placement& placement, const std::filesystem::path& scene);

}  // namespace mixrig::session

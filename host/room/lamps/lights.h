// SPDX-License-Identifier: Apache-2.0
// Finds the lamps of a room from the fisheye pictures of a take, a scanned room, or both.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/pose/tracker/take_pictures.h"
#include "host/room/lamps/lamp_tracks.h"
#include "host/room/lamps/lights_bracket.h"
#include "host/room/lamps/shading.h"
#include "host/scene/scene.h"

namespace mixrig::session {

struct LightsOptions {
  std::filesystem::path take;         ///< empty: only the room is used
  std::filesystem::path room;         ///< empty: only the take is used
  std::filesystem::path poses;        ///< TUM lines; empty: true poses, else tracked in the room
  bool poses_of_fisheye = false;      ///< `poses` are of the fisheye, else of the target camera
  std::filesystem::path calibration;  ///< empty: the take's
  std::optional<geometry::Pose> world_from_base;  ///< pose of the room; absent: as its folder says
  geometry::Pose otherwise_from_base;             ///< used if neither gives a pose
  std::filesystem::path drawing;     ///< PNG of a picture with its candidates; empty: none
  std::vector<BracketFile> bracket;  ///< pictures of the fisheye at one frame's place; empty: none
  int bracket_frame = 1;             ///< that frame of the take
  lights::LampOptions lamps;
  double exposure = 1;                     ///< of the scene that the lamps are for
  int threads = 0;                         ///< 0: one a core
  std::function<void(int, int)> progress;  ///< done and total; may be empty
};

struct RoomLights {
  lights::LampSearch search;
  std::vector<geometry::Lamp> lamps;  ///< search.lamps for a scene
  /// Light by the room's shading. Degenerate without a room, or if its shading does not show it;
  /// all lamps are then assumed to have the same radiance.
  estimation::Estimate<lights::RoomLight> light;
  /// Relative radiance of each lamp by LightsOptions::bracket; empty without one. With the lamps'
  /// sizes it gives the ratios of the intensities.
  std::vector<double> radiance;
  int pictures = 0, without_pose = 0;
};

/// Finds the lamps. Errors: kUsage without take and room, or without poses; those of take, room,
/// calibration and poses; kData if no picture has a pose; kIo of the drawing.
Result<RoomLights> find_lights(const LightsOptions& options);

/// {"lamps": [{"name", "position_m", "sigma_mm", "direction", "size_m", "intensity",
/// "solid_angle_sr", "pictures", "residual", "by", "radiance" (by a bracket)}], "rejected":
/// [{"reason", "text", "position_m", "from_m", "ray", "pictures"}], "pictures", "without_pose",
/// "light": {"intensity": "measured", "ambient", "sigma_share" (of each lamp, then of the ambient
/// light, over the sum of the intensities), "largest_share", "residual", "samples", "planes"} or
/// {"intensity": "assumed", "reason"}}.
nlohmann::json to_json(const RoomLights& lights);

/// Writes the lamps, and the ambient light if it was measured, into a scene file, whose other text
/// stays. Errors: those of reading, scene::with_lamps(), kIo.
Result<void> write_lights(const RoomLights& lights, const std::filesystem::path& scene);

}  // namespace mixrig::session

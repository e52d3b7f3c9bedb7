// SPDX-License-Identifier: Apache-2.0
// The lamps of a room, from the fisheye's pictures of a take, a scanned room, or both.
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
  std::filesystem::path take;         ///< empty: of the room alone
  std::filesystem::path room;         ///< empty: of the take alone
  std::filesystem::path poses;        ///< TUM lines; empty: true ones, else tracked in the room
  bool poses_of_fisheye = false;      ///< of the fisheye; else of the target camera
  std::filesystem::path calibration;  ///< empty: the take's
  std::optional<geometry::Pose> world_from_base;  ///< of the room; absent: as its folder says
  geometry::Pose otherwise_from_base;             ///< where neither says where the room stands
  std::filesystem::path drawing;     ///< PNG of a picture with its candidates; empty: none
  std::vector<BracketFile> bracket;  ///< of the take's fisheye at a picture's place; empty: none
  int bracket_frame = 1;             ///< of the take: that place
  lights::LampOptions lamps;
  double exposure = 1;                     ///< of the scene that they are for
  int threads = 0;                         ///< 0: one per core
  std::function<void(int, int)> progress;  ///< done and total; may be empty
};

struct RoomLights {
  lights::LampSearch search;
  std::vector<geometry::Lamp> lamps;  ///< search.lamps as a scene has them
  /// By the room's shading. Degenerate without a room, and where it does not tell; then all lamps
  /// have the same radiance, an assumption.
  estimation::Estimate<lights::RoomLight> light;
  /// Of each lamp, relative, by LightsOptions::bracket; empty without. Ratios of the intensities
  /// follow from it and the lamps' sizes.
  std::vector<double> radiance;
  int pictures = 0, without_pose = 0;
};

/// Errors: kUsage without a take and a room, or where nothing gives poses; those of take, room,
/// calibration and poses; kData where no picture has a pose; kIo of the drawing.
Result<RoomLights> find_lights(const LightsOptions& options);

/// {"lamps": [{"name", "position_m", "sigma_mm", "direction", "size_m", "intensity",
/// "solid_angle_sr", "pictures", "residual", "by", "radiance" (by a bracket)}], "rejected":
/// [{"reason", "text", "position_m", "from_m", "ray", "pictures"}], "pictures", "without_pose",
/// "light": {"intensity": "measured", "ambient", "sigma_share" (of each lamp, then of the ambient
/// light, over the sum of the intensities), "largest_share", "residual", "samples", "planes"} or
/// {"intensity": "assumed", "reason"}}.
nlohmann::json to_json(const RoomLights& lights);

/// Writes the lamps (and the ambient light, where it was measured) into a scene, whose other text
/// stays. Errors: those of reading, scene::with_lamps(), kIo.
Result<void> write_lights(const RoomLights& lights, const std::filesystem::path& scene);

}  // namespace mixrig::session

// SPDX-License-Identifier: Apache-2.0
// Work of the extra "map" for the commands track and align.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/result.h"
#include "host/math/geometry/pose.h"

namespace mixrig::tools {

struct MapTrackArguments {
  std::string map, take, calibration;
  std::string tum;                                ///< file for the poses; empty: none
  std::optional<geometry::Pose> world_from_room;  ///< as session::MapTrackOptions
  int threads = 0;
};
struct MapAlignArguments {
  std::string map, other, out;  ///< `other`: a second map, or a room
  std::string calibration;      ///< of the camera that learned the map; for placing it in a room
  int threads = 0;
};

/// Functions that print what they found and return the report; all null where the extra is left
/// out.
struct MapJobs {
  Result<nlohmann::json> (*track)(const MapTrackArguments& arguments) = nullptr;
  Result<nlohmann::json> (*join)(const MapAlignArguments& arguments) = nullptr;
  Result<nlohmann::json> (*place)(const MapAlignArguments& arguments) = nullptr;
};

/// Functions of the extra, built with it.
Result<nlohmann::json> track_in_map(const MapTrackArguments& arguments);
Result<nlohmann::json> join_maps(const MapAlignArguments& arguments);
Result<nlohmann::json> place_map(const MapAlignArguments& arguments);

}  // namespace mixrig::tools

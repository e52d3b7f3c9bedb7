// SPDX-License-Identifier: Apache-2.0
// What the board's build, which has no OpenCV, says instead of tracking in a learned map.
#include "extras/map/learn/map_track.h"

namespace mixrig::session {
namespace {

Error no_maps(const std::filesystem::path& map) {
  return {ErrorCode::kUnsupported,
          map.string() +
              ": the board's build knows no learned maps: use another machine, or a "
              "scanned room (--model)"};
}

}  // namespace

Result<MapTrack> track_map(const MapTrackOptions& options) { return no_maps(options.map); }

Result<nlohmann::json> place_map(const MapRoomOptions& options) { return no_maps(options.map); }

Result<nlohmann::json> join_maps(const std::filesystem::path& first, const std::filesystem::path&,
                                 const std::filesystem::path&) {
  return no_maps(first);
}

}  // namespace mixrig::session

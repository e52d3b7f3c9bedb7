// SPDX-License-Identifier: Apache-2.0
// A learned map as a folder: map.toml, points.bin, keys.tum, path.tum, keys/NNNN.png.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

#include "extras/map/reconstruction/maps/learned_map.h"
#include "hal/base/result.h"

namespace mixrig::reconstruction {

/// File whose presence marks a folder as a map.
inline constexpr const char* kMapManifest = "map.toml";

/// Writes the map whole or not at all, replacing an older map. Errors: kUsage where the folder
/// holds something else; kIo.
Result<void> write_map(const LearnedMap& map, const std::filesystem::path& folder);

/// Reads a map. Errors: kNotFound, kFormat (file:line, or what disagrees), kData for a picture that
/// cannot be read.
Result<LearnedMap> load_map(const std::filesystem::path& folder);

/// Contents of map.toml: fields of a map, and counts.
struct MapManifest {
  LearnedMap map;
  int keys = 0, points = 0, descriptors = 0;
};
/// Parses map.toml; `name` is the file's name in errors. Pure: fuzzers call it. Errors: kFormat.
Result<MapManifest> parse_map_manifest(std::string_view text, const std::string& name);

struct MapPoints {
  std::vector<MapPoint> points;
  std::vector<MapDescriptor> descriptors;
};
/// Parses points.bin (docs/reference/room_file.md) of a map with `keys` key pictures. Pure. Errors:
/// kFormat for another length than its header says, values that are not finite, and numbers out of
/// range.
Result<MapPoints> parse_map_points(std::span<const std::byte> bytes, int keys,
                                   const std::string& name);

/// Poses as lines of the TUM format "t x y z qx qy qz qw".
std::string tum_text(const std::vector<trajectory::TimedPose>& poses);

}  // namespace mixrig::reconstruction

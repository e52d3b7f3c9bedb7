// SPDX-License-Identifier: Apache-2.0
// A scanned room as a folder: manifest.toml, room.exr, pictures to look at.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "hal/base/result.h"
#include "host/model/panorama.h"

namespace mixrig::model {

/// What the folder says beside the pictures.
struct RoomManifest {
  int views = 0, frames = 0;
  int triangles = 0;
  double mesh_tolerance_m = 0;
  std::string calibration_hash;       ///< of the calibration that the sweep was fused with
  geometry::Vignetting vignetting{};  ///< of the target camera, taken out of the colour
  std::optional<geometry::Pose> world_from_base{};  ///< where the views had poses of their own
};

struct RoomFile {
  Panorama panorama;
  RoomManifest manifest;
};

/// Whether the folder says that it is a room; what is wrong in it, load_room() tells.
bool is_room(const std::filesystem::path& folder);

/// Writes manifest.toml, room.exr (distance_m, sigma_m, views), color.png and distance.png (16 bit,
/// mm) into a folder that exists. Errors: kIo.
Result<void> write_room(const Panorama& panorama, const RoomManifest& manifest,
                        const std::filesystem::path& folder);

/// Without reading the pictures. Errors: kNotFound, kFormat.
Result<RoomManifest> read_manifest(const std::filesystem::path& folder);

/// Field is what is known. Errors: kNotFound, kFormat, kData (sizes that disagree).
Result<RoomFile> load_room(const std::filesystem::path& folder);

}  // namespace mixrig::model

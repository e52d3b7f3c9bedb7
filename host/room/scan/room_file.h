// SPDX-License-Identifier: Apache-2.0
// A scanned room as a folder: manifest.toml, room.exr, pictures to look at.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Contents of manifest.toml.
struct RoomManifest {
  int views = 0, frames = 0;
  int triangles = 0;
  double mesh_tolerance_m = 0;
  std::string calibration_hash;       ///< hash of the sweep's calibration; empty: it had none
  geometry::Vignetting vignetting{};  ///< of the target camera, removed from the colour
  std::optional<geometry::Pose> world_from_base{};  ///< absent unless the views had their own poses
  double distance_sigma = 0;  ///< sigma of the relative error of all distances; 0: unknown
};

struct RoomFile {
  Panorama panorama;
  RoomManifest manifest;
};

/// Whether the folder has a room's manifest. load_room() reports what is wrong in it.
bool is_room(const std::filesystem::path& folder);

/// Writes manifest.toml, room.exr (distance_m, sigma_m, views), color.png, distance.png (16 bit,
/// mm) and, where the room has light, color.exr into a folder that exists. Errors: kIo.
Result<void> write_room(const Panorama& panorama, const RoomManifest& manifest,
                        const std::filesystem::path& folder);

/// Reads the manifest without the pictures. Errors: kNotFound, kFormat.
Result<RoomManifest> read_manifest(const std::filesystem::path& folder);

/// Reads a room without Panorama::light; its field is where distances are known. Errors: kNotFound,
/// kFormat, kData (sizes that disagree).
Result<RoomFile> load_room(const std::filesystem::path& folder);

/// Adds the light of color.exr to the panorama of that folder; empty without such a file. Errors:
/// kFormat, kData (another size than the colour's).
Result<void> load_light(const std::filesystem::path& folder, Panorama& panorama);

/// Place of a room in a joined room: pose of its base in the first one's axes.
struct JoinedPlace {
  std::string folder;  ///< beside manifest.toml
  geometry::Pose first_from_base;
  double sigma_m = 0, sigma_rad = 0;  ///< of the pose, along its worst axis; 0 for the first room
};

/// Most rooms in a joined one, as many as a compositor draws; there are at least two.
inline constexpr std::size_t kMostJoined = 4;

/// Writes the manifest of a joined room; the rooms themselves are folders beside it. Errors: kIo.
Result<void> write_joined(std::span<const JoinedPlace> rooms, int triangles,
                          const std::filesystem::path& folder);

struct PlacedRoom {
  RoomFile room;
  geometry::Pose first_from_base;
  double sigma_m = 0, sigma_rad = 0;
};

/// Reads one room, or all rooms of a joined one, in order. Errors: those of load_room(); kFormat
/// also for a folder name that leads elsewhere, and for a joined room within a joined one.
Result<std::vector<PlacedRoom>> load_rooms(const std::filesystem::path& folder);

}  // namespace mixrig::model

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

/// What the folder says beside the pictures.
struct RoomManifest {
  int views = 0, frames = 0;
  int triangles = 0;
  double mesh_tolerance_m = 0;
  std::string calibration_hash;       ///< of the calibration that the sweep was fused with
  geometry::Vignetting vignetting{};  ///< of the target camera, taken out of the colour
  std::optional<geometry::Pose> world_from_base{};  ///< where the views had poses of their own
  double distance_sigma = 0;  ///< of what all distances have in common, as a share of them; 0:
                              ///< not known
};

struct RoomFile {
  Panorama panorama;
  RoomManifest manifest;
};

/// Whether the folder says that it is a room; what is wrong in it, load_room() tells.
bool is_room(const std::filesystem::path& folder);

/// Writes manifest.toml, room.exr (distance_m, sigma_m, views), color.png, distance.png (16 bit,
/// mm) and, where the room has light, color.exr into a folder that exists. Errors: kIo.
Result<void> write_room(const Panorama& panorama, const RoomManifest& manifest,
                        const std::filesystem::path& folder);

/// Without reading the pictures. Errors: kNotFound, kFormat.
Result<RoomManifest> read_manifest(const std::filesystem::path& folder);

/// Field is what is known. Without Panorama::light. Errors: kNotFound, kFormat, kData (sizes that
/// disagree).
Result<RoomFile> load_room(const std::filesystem::path& folder);

/// Adds the light of color.exr to the panorama of that folder; none where there is no such file.
/// Errors: kFormat, kData (another size than the colour's).
Result<void> load_light(const std::filesystem::path& folder, Panorama& panorama);

/// A room that is joined with others: where the foot of its head stood in the first one's axes.
struct JoinedPlace {
  std::string folder;  ///< beside manifest.toml
  geometry::Pose first_from_base;
  double sigma_m = 0, sigma_rad = 0;  ///< of the pose, along its worst axis; 0 of the first
};

/// At least two, at most this many (as many as a compositor draws).
inline constexpr std::size_t kMostJoined = 4;

/// Writes the manifest of a joined room; the rooms themselves are folders beside it. Errors: kIo.
Result<void> write_joined(std::span<const JoinedPlace> rooms, int triangles,
                          const std::filesystem::path& folder);

struct PlacedRoom {
  RoomFile room;
  geometry::Pose first_from_base;
  double sigma_m = 0, sigma_rad = 0;
};

/// One room, or all rooms of a joined one, the first first. Errors as load_room; kFormat also for
/// a folder name that leads elsewhere, and for a joined room within a joined one.
Result<std::vector<PlacedRoom>> load_rooms(const std::filesystem::path& folder);

}  // namespace mixrig::model

// SPDX-License-Identifier: Apache-2.0
// Joins scanned rooms of one place into one.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "host/room/registration/room_registration.h"
#include "host/room/scan/room_file.h"

namespace mixrig::session {

struct RoomMergeOptions {
  /// 2 to model::kMostJoined; the first defines the axes.
  std::vector<std::filesystem::path> rooms;
  std::filesystem::path out;
  /// Approximate pose of the second; for two rooms only.
  std::optional<geometry::Pose> near_first_from_base;
  int threads = 0;  ///< 0: one a core
};

struct RoomMerge {
  std::vector<model::Registration> registrations;  ///< of the second and later rooms
  std::size_t triangles = 0, triangles_alone = 0;  ///< of the joined mesh; of the rooms' own meshes
  double register_seconds = 0, mesh_seconds = 0, seconds = 0;
};

/// Registers each room to the first and writes `out`: copies of the rooms, manifest.toml, room.glb;
/// whole or not at all. Errors: those of the rooms; kUsage for a folder that is no room or a joined
/// room, a room that is given twice or is OUT, less than two or more than four rooms, an OUT that
/// is a scanned room or something else; kData if they cannot be joined; kIo.
Result<RoomMerge> merge_rooms(const RoomMergeOptions& options);

}  // namespace mixrig::session

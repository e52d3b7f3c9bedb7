// SPDX-License-Identifier: Apache-2.0
// Scanned rooms of one place joined into one.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "host/room/registration/room_registration.h"
#include "host/room/scan/room_file.h"

namespace mixrig::session {

struct RoomMergeOptions {
  std::vector<std::filesystem::path> rooms;  ///< 2 to model::kMostJoined; the first gives the axes
  std::filesystem::path out;
  std::optional<geometry::Pose> near_first_from_base;  ///< of the second, of two rooms
  int threads = 0;                                     ///< 0: one per core
};

struct RoomMerge {
  std::vector<model::Registration> registrations;  ///< of the second and later rooms
  std::size_t triangles = 0, triangles_alone = 0;  ///< of the joined mesh, of the rooms' own
  double register_seconds = 0, mesh_seconds = 0, seconds = 0;
};

/// Registers each room to the first and writes `out`: copies of the rooms, manifest.toml, room.glb;
/// whole or not at all. Errors: those of the rooms; kUsage for what is no room or a joined one
/// among them, one that is given twice or is OUT, fewer than two or more than four, an OUT that is
/// a scanned room or something else; kData where they cannot be joined; kIo.
Result<RoomMerge> merge_rooms(const RoomMergeOptions& options);

}  // namespace mixrig::session

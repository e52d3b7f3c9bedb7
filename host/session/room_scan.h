// SPDX-License-Identifier: Apache-2.0
// From a recorded sweep of the head to a panorama of the room on disk.
#pragma once

#include <filesystem>
#include <optional>

#include "host/capture/capture_source.h"
#include "host/measure/room.h"
#include "host/model/panorama.h"
#include "host/model/room_mesh.h"

namespace mixrig::session {

struct RoomScanOptions {
  std::filesystem::path take;
  std::filesystem::path calibration;  ///< cameras, depth error and the pan-tilt unit
  bool evaluate = false;              ///< against the room that the take holds as truth
  int height_px = 720;                ///< of the panorama; its width is twice that
  bool smooth = true;                 ///< the rung: false is the plain fusion
  int threads = 0;                    ///< 0: one per core
};

struct RoomScan {
  model::Panorama panorama;
  model::RoomMesh mesh;
  std::size_t triangles_raw = 0;  ///< of the grid; the mesh has fewer
  double tolerance_m = 0;         ///< of the mesh
  int views = 0, frames = 0;
  double read_seconds = 0;   ///< reading and averaging the take
  double model_seconds = 0;  ///< from averaged views to the panorama
  double mesh_seconds = 0;   ///< from the panorama to the mesh
  std::optional<measure::RoomErrors> errors;
};

/// Frames of equal angles in sequence are one view. Errors: those of take and calibration; kFormat
/// where the calibration has no unit, kData where a frame has no angles; kNotFound where
/// `evaluate` finds no truth.
Result<RoomScan> scan_room(const RoomScanOptions& options);

/// Writes room.exr (distance_m, sigma_m, views), color.png, distance.png (16 bit, mm), room.glb
/// (where there are triangles) and manifest.toml into `folder`: whole or not at all. Errors: kUsage
/// where the folder is something else, kIo.
Result<void> save_room(const RoomScan& scan, const std::filesystem::path& calibration,
                       const std::filesystem::path& folder);

}  // namespace mixrig::session

// SPDX-License-Identifier: Apache-2.0
// From a recorded sweep of the head to a panorama of the room on disk.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "host/capture/capture/capture_source.h"
#include "host/judge/measure/room.h"
#include "host/judge/measure/room_light.h"
#include "host/judge/measure/room_mesh.h"
#include "host/room/scan/panorama/panorama.h"
#include "host/room/scan/panorama/view_alignment.h"
#include "host/room/scan/panorama/view_light.h"
#include "host/room/scan/shape/room_findings.h"
#include "host/room/scan/shape/room_mesh.h"
#include "host/room/sweep/sweep_bounce.h"

namespace mixrig::session {

/// Least turn of a view; views that disagree by less keep the angles of the unit.
inline constexpr double kLeastTurn_deg = 0.05;

struct RoomScanOptions {
  std::filesystem::path take;
  /// Cameras, depth error and the pan-tilt unit. Empty: those of the take, whose frames have poses.
  std::filesystem::path calibration;
  bool evaluate = false;            ///< compares with the true room that the take holds
  bool align = true;                ///< turns views that do not agree with their neighbours
  std::optional<Size> field_deg{};  ///< field that the sweep was to cover, pan x tilt around ahead
  /// Modulation frequency of a phase camera: light that walls throw on each other is taken out of
  /// the distances. 0: it is left in.
  double modulation_hz = 0;
  model::PanoramaOptions panorama;
  std::optional<double> mesh_tolerance_m{};  ///< replaces model::mesh_tolerance_m()
  int threads = 0;                           ///< 0: one per core
};

/// Largest distance of the boards of the depth camera's calibration, and the share of the room
/// beyond it, where the depth error of the farthest board is assumed.
struct DepthReach {
  double far_m = 0;
  double beyond_pct = 0;  ///< of the known solid angle
};

struct RoomScan {
  model::Panorama panorama;
  model::Alignment alignment;  ///< agreement of the views at the unit's angles or the given poses
  std::vector<model::Finding> findings;
  std::vector<model::FoundExposure> exposures;  ///< exposures of the take's brackets; empty without
  std::optional<BouncedRoomLight> bounced;      ///< absent without a modulation frequency
  std::optional<DepthReach> depth_reach;        ///< absent unless the calibration has a depth error
  model::RoomMesh mesh;
  std::size_t triangles_raw = 0;  ///< triangles of the grid; the mesh has fewer
  double tolerance_m = 0;         ///< tolerance of the mesh
  int views = 0, frames = 0;
  std::optional<geometry::Pose> world_from_base;  ///< absent unless frames had poses
  double read_seconds = 0;                        ///< reading and averaging the take
  double align_seconds = 0;                       ///< part of model_seconds
  double model_seconds = 0;                       ///< from averaged views to the panorama
  double mesh_seconds = 0;                        ///< from the panorama to the mesh
  std::optional<measure::RoomErrors> errors;
  Image<float> off_mm;  ///< measure::off_surface_mm, with `evaluate`
  std::optional<measure::RoomLightErrors> light_errors;  ///< where light and its truth exist
  std::optional<measure::MeshErrors> mesh_errors;        ///< against the panorama; with `evaluate`
};

struct JudgedRoom {
  measure::RoomErrors errors;
  Image<float> off_mm;  ///< measure::off_surface_mm
};

/// Compares with the truth in a studio's take of a sweep. Where the panorama has another size, the
/// truth is interpolated between its pixels, but not across depth steps. Errors: kNotFound without
/// truth; those of reading it.
Result<JudgedRoom> judge_room(const model::Panorama& panorama, const std::filesystem::path& take);

/// Makes a room of a sweep. Consecutive frames of equal angles are one view; without a calibration
/// each frame is one, at its own pose. Errors: those of take and calibration; kFormat where the
/// calibration has no unit, kData where a frame has no angles, kUsage where it has no pose;
/// kNotFound where `evaluate` finds no truth.
Result<RoomScan> scan_room(const RoomScanOptions& options);

/// Writes a room's triangles with their picture as glTF; no file where there are none. Errors: kIo.
Result<void> write_mesh(const model::RoomMesh& mesh, const Image<Rgb8>& color,
                        const std::filesystem::path& path);

/// Writes room.exr (distance_m, sigma_m, views), color.png, distance.png (16 bit, mm), color.exr
/// (where plates were taken at other exposures), room.glb (where there are triangles), error.png
/// (of a judged room) and manifest.toml into `folder`, whole or not at all. Errors: kUsage where
/// the folder is something else, kIo.
Result<void> save_room(const RoomScan& scan, const std::filesystem::path& calibration,
                       const std::filesystem::path& folder);

}  // namespace mixrig::session

// SPDX-License-Identifier: Apache-2.0
// A session: a scene, the frames it is composited into, and the setup of the compositor.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/frame_range.h"
#include "hal/base/progress.h"
#include "hal/base/result.h"
#include "host/capture/calibration_file/choice.h"
#include "host/capture/capture/pose_source.h"
#include "host/capture/open/open_source.h"
#include "host/render/backend/backend.h"
#include "host/render/contract/compositor.h"
#include "host/room/background/static_background.h"
#include "host/room/scan/shape/room_faces.h"
#include "host/run/session/extra_poses.h"
#include "host/run/session/scene_setup.h"
#include "host/scene/scene.h"

namespace mixrig::session {

struct SessionOptions {
  std::filesystem::path scene;
  std::string source;             ///< as for open_source(), or "rig[:RIG.TOML]": live devices
  std::optional<Size> view_size;  ///< size to composite at; absent: that of the take's view
  BackendChoice backend;
  /// calibration.toml; empty: that of the scene or the source.
  std::filesystem::path calibration{};
  Clock* clock = nullptr;                   ///< for a rig's devices
  const std::atomic<bool>* stop = nullptr;  ///< ends a rig's frames
  PlayOptions play{};                       ///< for recordings that a rig plays
  std::vector<ExtraPoses> extra_poses{};    ///< pose sources of extras in this build
  SourceKinds kinds{};                      ///< sources and devices of extras
};

/// All data that is constant during a run. `setup` points into the other members, so a session
/// cannot be moved. Not thread-safe.
struct Session {
  Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  scene::Scene scene;
  std::unique_ptr<capture::CaptureSource> source;
  std::shared_ptr<live::CameraSettings> cameras;      ///< of `source`; null: no live devices
  std::shared_ptr<live::RunningRig> rig;              ///< of `source`; null: no live devices
  calibration_file::CalibrationChoice calibration;    ///< which calibration is used, and why
  std::optional<model::StaticBackground> background;  ///< a single view of the room
  std::vector<model::RoomFaces> rooms;                ///< or the whole room, one entry a scan
  Image<Rgbx8> wide_color;  ///< colours of `background`, if it is drawn for each pose
  std::unique_ptr<capture::PoseSource> poses;  ///< of the scene; null before prepare_poses()
  std::vector<MeshArrays> meshes;
  Image<Rgb8> backdrop;  ///< the set's picture in the view's size; may be empty
  render::CompositorSetup setup;
  BackendChoice backend;
  std::vector<ExtraPoses> extra_poses;  ///< pose sources of extras in this build

  bool is_live() const { return source->info().is_live(); }
  /// Pose of the target camera at a frame, by `poses`; the identity if it is lost. Before
  /// prepare_poses(), that of the capture.
  geometry::Pose world_from_target(const capture::Capture& capture) const;
  /// Frames to composite by default: those after the learned ones, or those before them if the take
  /// ends with the learned ones.
  FrameRange default_frames() const;
};

/// Opens scene and source and prepares the setup except the background. Errors: those of scene and
/// take; kFormat if the scene learns from frames that the take lacks.
Result<std::unique_ptr<Session>> open_session(const SessionOptions& options);

/// Learns or loads the scene's background; the session is then ready to composite. Learns by
/// session.poses if the camera moves, so call it after prepare_poses(), except for pose = "floor".
/// Errors: kFormat if the scene requires a floor that is not known; kData if the background is of
/// another view, or the camera moves and no learned frame has a pose; those of reading and
/// composing.
Result<void> prepare_background(Session& session, const ProgressFn& progress);

/// Setup from a take alone: cameras and noise, without objects, lamps or background. Errors: kUsage
/// for a view size outside 1..16384.
Result<render::CompositorSetup> setup_of(const capture::SourceInfo& info,
                                         std::optional<Size> view_size);

/// Returns a view with the field of view of `view` on a grid of `size` pixels.
geometry::Pinhole resized(const geometry::Pinhole& view, Size size);

}  // namespace mixrig::session

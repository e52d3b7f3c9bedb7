// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/poses/scene_poses.h"

#include <utility>

#include "extras/broadcast/poses/camera_stream.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/run/session/session.h"

namespace mixrig::broadcast {
namespace {

using session::Session;

/// Options of a tracker's stream. Without the pose of a body in the calibration the tracked camera
/// is the target camera.
Result<pose::CameraStreamOptions> stream_options(const Session& session) {
  const scene::TrackerStream& wanted = session.scene.camera.stream;
  pose::CameraStreamOptions options;
  options.address = wanted.address;
  options.world_from_tracker = wanted.world_from_tracker;
  options.delay_s = wanted.delay_s;
  options.most_ahead_s = session.scene.camera.max_age_s;
  options.rate_hz = wanted.rate_hz;
  options.stamps = wanted.stamps;
  if (wanted.sigma_m && wanted.sigma_rad) options.noise = {*wanted.sigma_rad, *wanted.sigma_m};
  if (session.calibration.file.empty()) return options;
  MIXRIG_ASSIGN(const calibration_file::Calibration known,
                calibration_file::read_calibration(session.calibration.file));
  if (const auto* body = known.pose("body")) options.mount = pose::mount_of(*body);
  return options;
}

Result<std::unique_ptr<capture::PoseSource>> open(const Session& session, const Clock* clock) {
  MIXRIG_ASSIGN(pose::CameraStreamOptions options, stream_options(session));
  if (clock == nullptr) return std::unique_ptr<capture::PoseSource>();
  auto poses = session.scene.pose_source == scene::PoseSource::kFreeD
                   ? pose::open_freed_poses(std::move(options), *clock)
                   : pose::open_opentrack_poses(std::move(options), *clock);
  if (!poses) return at_camera(session, "pose", poses.error().code, to_line(poses.error()));
  return poses;
}

}  // namespace

std::array<session::ExtraPoses, 2> scene_poses() {
  return {{{scene::PoseSource::kFreeD, open}, {scene::PoseSource::kOpenTrack, open}}};
}

}  // namespace mixrig::broadcast

// SPDX-License-Identifier: Apache-2.0
#include "host/run/session/camera_pose.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/live/rig/device_kind.h"
#include "host/pose/mocap/mocap_poses.h"
#include "host/pose/source/fixed_poses.h"
#include "host/pose/source/pan_tilt_poses.h"
#include "host/pose/source/recorded_poses.h"
#include "host/pose/source/world_frame.h"
#include "host/run/session/tracker_pose.h"
#include "host/scene/pose_kind.h"

namespace mixrig::session {

Error at_camera(const Session& session, const char* key, ErrorCode code, const std::string& what) {
  return {code, session.scene.path.string() + ": camera." + key + ": " + what};
}

namespace {

using Poses = Result<std::unique_ptr<capture::PoseSource>>;

Result<capture::Capture> capture_of(const Session& session, int number) {
  capture::Capture capture;
  MIXRIG_ASSIGN(const bool there, session.source->read(number, capture));
  if (!there) return Error{ErrorCode::kData, "the source has no frame " + std::to_string(number)};
  return capture;
}

Poses own_recorded_poses(const Session& session) {
  if (!session.is_live()) {
    MIXRIG_ASSIGN(const capture::Capture first, capture_of(session, 1));
    if (first.pose_origin != capture::PoseOrigin::kRecorded)
      return at_camera(session, "pose", ErrorCode::kFormat,
                       "\"recorded\", but the take has no poses of its own: name a file by "
                       "camera.trajectory, or use another pose");
  }
  return pose::make_own_poses(true);
}

Poses trajectory_poses(const Session& session) {
  const scene::CameraPoses& wanted = session.scene.camera;
  if (session.is_live())
    return at_camera(session, "trajectory", ErrorCode::kUsage,
                     "a recorded trajectory cannot belong to live devices: use pose = "
                     "\"mocap:HOST\" or \"pan_tilt\"");
  auto poses = pose::RecordedPoses::open(wanted.trajectory,
                                         {wanted.trajectory.string(), wanted.time_offset_s});
  if (!poses) return at_camera(session, "trajectory", poses.error().code, poses.error().context);
  const auto [first_s, last_s] = (*poses)->span_s();
  MIXRIG_ASSIGN(const capture::Capture first, capture_of(session, 1));
  MIXRIG_ASSIGN(const capture::Capture last, capture_of(session, session.source->info().frames));
  if (last.time_s < first_s || first.time_s > last_s)
    return at_camera(
        session, "trajectory", ErrorCode::kData,
        fmt::format("{} has poses from {:.3f} to {:.3f} s of the take, whose frames are at {:.3f} "
                    "to {:.3f} s: no time in common, correct time_offset_s (mixrig align finds it)",
                    wanted.trajectory.string(), first_s, last_s, first.time_s, last.time_s));
  return std::unique_ptr<capture::PoseSource>(*std::move(poses));
}

/// The chain of the calibration that is in use; nullopt where there is none.
Result<std::optional<calibration_file::PanTilt>> chain_of(const Session& session) {
  if (session.calibration.file.empty()) return std::optional<calibration_file::PanTilt>();
  MIXRIG_ASSIGN(calibration_file::Calibration known,
                calibration_file::read_calibration(session.calibration.file));
  return std::move(known.pan_tilt);
}

Poses pan_tilt_poses(const Session& session) {
  MIXRIG_ASSIGN(const auto chain, chain_of(session));
  if (!chain)
    return at_camera(session, "pose", ErrorCode::kFormat,
                     fmt::format("\"pan_tilt\", but {} has no [pan_tilt]: calibrate the chain by "
                                 "mixrig calibrate ptu, and name its calibration.toml by "
                                 "`calibration` or --calibration",
                                 session.calibration.where));
  if (!session.is_live()) {
    MIXRIG_ASSIGN(const capture::Capture first, capture_of(session, 1));
    if (!first.pan_tilt &&
        first.status_of(capture::Stream::kPanTilt) == capture::StreamStatus::kAbsent)
      return at_camera(session, "pose", ErrorCode::kFormat,
                       "\"pan_tilt\", but the take has no angles of the head: record it with the "
                       "head in rig.toml (pan_tilt.csv)");
  }
  return pose::make_pan_tilt_poses(*chain, session.scene.camera.world_from_base);
}

Poses floor_pose(const Session& session) {
  // prepare_background() has refused a scene without a floor.
  return pose::make_fixed_pose(world_from_camera_on_floor(*session.background->floor), "floor",
                               "fixed on the floor of the learned background");
}

Result<pose::MocapOptions> mocap_options(const Session& session) {
  const scene::MocapSettings& wanted = session.scene.camera.mocap;
  pose::MocapOptions options;
  options.body_id = wanted.body;
  options.up = wanted.y_up ? mocap::Up::kY : mocap::Up::kZ;
  options.delay_s = wanted.delay_s;
  options.most_ahead_s = session.scene.camera.max_age_s;
  if (!wanted.constellation.empty()) {
    MIXRIG_ASSIGN(options.constellation, mocap::read_constellation(wanted.constellation));
  }
  calibration_file::Calibration known;
  if (!session.calibration.file.empty()) {
    MIXRIG_ASSIGN(known, calibration_file::read_calibration(session.calibration.file));
  }
  const calibration_file::CalibratedPose* body = known.pose("body");
  if (body == nullptr)
    return at_camera(session, "pose", ErrorCode::kFormat,
                     fmt::format("\"mocap\", but {} has no pose of the tracked body: make it by "
                                 "mixrig calibrate external --calibration, and name its "
                                 "calibration.toml by `calibration` or --calibration",
                                 session.calibration.where));
  options.mount = pose::mount_of(*body);
  return options;
}

/// Poses of a tracker that an extra provides; null without a clock.
Poses extra_poses(const Session& session, const Clock* clock) {
  for (const ExtraPoses& extra : session.extra_poses)
    if (extra.source == session.scene.pose_source) return extra.open(session, clock);
  return live::extra_left_out(session.scene.path.string() + ": camera.pose = \"" +
                                  scene::name(session.scene.pose_source) + "\"",
                              "broadcast");
}

/// Poses of a motion capture system; null without a clock.
Poses mocap_poses(const Session& session, const Clock* clock) {
  MIXRIG_ASSIGN(pose::MocapOptions options, mocap_options(session));
  if (clock == nullptr) return std::unique_ptr<capture::PoseSource>();
  return pose::open_mocap_poses(session.scene.camera.mocap.server, std::move(options), *clock);
}

/// Poses of the scene's source. Without a clock those of a network are only checked, and null.
Poses make_poses(const Session& session, const Clock* clock) {
  const scene::PoseKind& kind = scene::kind_of(session.scene.pose_source);
  if (kind.is_live && !session.is_live())
    return at_camera(
        session, "pose", ErrorCode::kUsage,
        fmt::format("live poses (\"{}\") cannot belong to a recording: record a trajectory "
                    "(of mocap: mixrig track --mocap) and use pose = \"recorded\"",
                    kind.name));
  switch (session.scene.pose_source) {
    case scene::PoseSource::kTake:
      return pose::make_own_poses(false, session.source->info().moves);
    case scene::PoseSource::kFloor:
      return floor_pose(session);
    case scene::PoseSource::kIdentity:
      return pose::make_fixed_pose({}, "identity", "fixed at the origin of the world");
    case scene::PoseSource::kFixed:
      return pose::make_fixed_pose(session.scene.camera.world_from_target, "fixed",
                                   "fixed by the scene");
    case scene::PoseSource::kRecorded:
      return session.scene.camera.trajectory.empty() ? own_recorded_poses(session)
                                                     : trajectory_poses(session);
    case scene::PoseSource::kPanTilt:
      return pan_tilt_poses(session);
    case scene::PoseSource::kTracker:
      return tracker_poses(session);
    case scene::PoseSource::kFreeD:
    case scene::PoseSource::kOpenTrack:
      return extra_poses(session, clock);
    case scene::PoseSource::kMocap:
      break;
  }
  return mocap_poses(session, clock);
}

}  // namespace

Result<void> check_poses(Session& session) {
  if (session.scene.pose_source == scene::PoseSource::kFloor) return {};
  MIXRIG_ASSIGN(session.poses, make_poses(session, nullptr));
  return {};
}

Result<void> prepare_poses(Session& session, const Clock& clock) {
  if (session.poses) return {};
  MIXRIG_ASSIGN(session.poses, make_poses(session, &clock));
  return {};
}

pose::FramePoseOptions frame_pose_options(const scene::Scene& scene) {
  return {scene.camera.max_age_s, scene.camera.when_lost == scene::WhenLost::kHide
                                      ? pose::WhenLost::kHide
                                      : pose::WhenLost::kFreeze};
}

geometry::Pose Session::world_from_target(const capture::Capture& capture) const {
  return poses ? poses->pose_of(capture).world_from_target : capture.world_from_target;
}

std::optional<std::string> HeadWatch::fault(const Session& session,
                                            const capture::Capture& capture) {
  const bool own = session.scene.pose_source == scene::PoseSource::kTake;
  const bool follows =
      own ? capture.pose_origin == capture::PoseOrigin::kRecorded : session.poses->info().moves;
  if (!capture.pan_tilt || follows) return std::nullopt;
  if (!first_) first_ = capture.pan_tilt;
  const double turned_rad = std::max(std::abs(capture.pan_tilt->pan_rad - first_->pan_rad),
                                     std::abs(capture.pan_tilt->tilt_rad - first_->tilt_rad));
  if (!(turned_rad > kStill_rad)) return std::nullopt;
  const auto chain = chain_of(session);
  const bool calibrated = chain && *chain;
  return fmt::format(
      "{}: camera.pose = \"{}\": the head has turned by {:.1f} deg at frame {}, but this pose does "
      "not follow it: {}",
      session.scene.path.string(), scene::name(session.scene.pose_source),
      turned_rad * 180 / std::numbers::pi, capture.number,
      calibrated ? "use pose = \"pan_tilt\", its chain is calibrated"
                 : "calibrate its chain by mixrig calibrate ptu and use pose = \"pan_tilt\", or "
                   "keep the head still");
}

}  // namespace mixrig::session

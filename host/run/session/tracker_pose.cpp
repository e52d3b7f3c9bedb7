// SPDX-License-Identifier: Apache-2.0
#include "host/run/session/tracker_pose.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "host/capture/calibration_file/calibration.h"
#include "host/pose/tracker/rig_camera.h"
#include "host/pose/tracker/tracker_poses.h"
#include "host/room/scan/room_file.h"

namespace mixrig::session {
namespace {

Error at_pose(const Session& session, ErrorCode code, const std::string& what) {
  return {code, session.scene.path.string() + ": camera.pose: \"tracker\", but " + what};
}

/// Checks that the fisheye's pictures have the calibrated size; for a recording also that its first
/// capture has a fisheye picture, and head angles where the prediction needs them.
Result<void> check_source(const Session& session, Size calibrated_px) {
  Size size = session.source->info().fisheye_px;
  if (!session.source->info().is_live()) {
    capture::Capture first;
    MIXRIG_ASSIGN(const bool there, session.source->read(1, first));
    if (session.scene.camera.predict != scene::Predict::kVelocity &&
        first.status_of(capture::Stream::kPanTilt) == capture::StreamStatus::kAbsent)
      return at_pose(session, ErrorCode::kData,
                     "camera.predict needs the angles of the head, and the take has none "
                     "(pan_tilt.csv): use predict = \"velocity\"");
    if (!there || first.status_of(capture::Stream::kFisheye) == capture::StreamStatus::kAbsent)
      return at_pose(
          session, ErrorCode::kData,
          "the take has no pictures of a fisheye: record it with the fisheye in rig.toml");
    size = first.fisheye.size();
  }
  if (size.empty() || size == calibrated_px) return {};
  return at_pose(session, ErrorCode::kData,
                 fmt::format("the fisheye's pictures have {}x{} pixels and it was calibrated with "
                             "{}x{}: calibrate it with pictures of that size",
                             size.width, size.height, calibrated_px.width, calibrated_px.height));
}

Result<void> set_prediction(const Session& session, pose::TrackerPoseOptions& options) {
  options.predict = static_cast<pose::Predict>(session.scene.camera.predict);
  if (options.predict == pose::Predict::kVelocity) return {};
  MIXRIG_ASSIGN(const auto known, calibration_file::read_calibration(session.calibration.file));
  options.head = known.pan_tilt;
  if (options.head) return {};
  return {Error{ErrorCode::kFormat,
                fmt::format("{}: camera.predict: needs the head's chain, but {} has no [pan_tilt]: "
                            "calibrate it by mixrig calibrate ptu, or use \"velocity\"",
                            session.scene.path.string(), session.calibration.file.string())}};
}

}  // namespace

Result<std::unique_ptr<capture::PoseSource>> tracker_poses(const Session& session) {
  const scene::Background& background = session.scene.background;
  if (!background.model || !model::is_room(*background.model))
    return at_pose(session, ErrorCode::kFormat,
                   "the background is no scanned room: scan it by mixrig scan and name it by "
                   "background.model");
  // Uses the first of joined rooms.
  MIXRIG_ASSIGN(const auto rooms, model::load_rooms(*background.model));
  const model::RoomFile& room = rooms.front().room;
  const auto place =
      background.world_from_base ? background.world_from_base : room.manifest.world_from_base;
  if (!place)
    return at_pose(session, ErrorCode::kFormat,
                   background.model->string() +
                       " does not say where it stands: give background.world_from_base");
  if (session.calibration.file.empty())
    return at_pose(session, ErrorCode::kFormat,
                   fmt::format("{} has no fisheye: name a calibration.toml that has one by "
                               "`calibration` or --calibration",
                               session.calibration.where));
  MIXRIG_ASSIGN(const RigCamera fisheye, rig_camera(session.calibration.file, "fisheye"));
  MIXRIG_TRY(check_source(session, geometry::size_px(fisheye.model)));
  pose::TrackerPoseOptions options;
  options.fisheye = fisheye.model;
  options.fisheye_from_target = fisheye.camera_from_target;
  options.world_from_base = *place;
  options.smooth_s = session.scene.camera.smooth_s;
  options.tracker.distance_sigma = room.manifest.distance_sigma;
  MIXRIG_TRY(set_prediction(session, options));
  return pose::make_tracker_poses(room.panorama, options);
}

}  // namespace mixrig::session

// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/take_pictures.h"

#include <algorithm>

#include <fmt/format.h>

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;
constexpr const char* kTruthOfFisheye = "truth/fisheye.tum";

}  // namespace

Result<RigCamera> tracked_camera(TrackedCamera camera, const fs::path& calibration,
                                 const capture::SourceInfo& info) {
  const fs::path& path = calibration.empty() ? info.calibration : calibration;
  const bool by_plate = camera == TrackedCamera::kTarget;
  if (by_plate && path.empty()) return RigCamera{info.target, {}};
  if (path.empty())
    return Error{ErrorCode::kUsage,
                 "the take does not say where its fisheye is: give its calibration.toml by "
                 "--calibration"};
  return rig_camera(path, by_plate ? "target" : "fisheye");
}

TakePicture picture_of(const capture::Capture& capture, TrackedCamera camera) {
  if (camera == TrackedCamera::kTarget)
    return {capture.plate.empty() ? nullptr : &capture.plate, capture.time_s};
  if (capture.status_of(capture::Stream::kFisheye) != capture::StreamStatus::kFresh) return {};
  const double behind_s = seconds(capture.mid_exposure - capture.fisheye_mid_exposure);
  return {&capture.fisheye, capture.time_s - behind_s};
}

Result<void> check_size(const TakePicture& picture, const geometry::AnyCamera& camera,
                        const fs::path& take) {
  const Size is = picture.image->size(), wanted = geometry::size_px(camera);
  if (is == wanted) return {};
  return Error{ErrorCode::kData,
               fmt::format("{}: pictures of {}x{}, but the camera was calibrated with {}x{}: "
                           "calibrate it at that size",
                           take.string(), is.width, is.height, wanted.width, wanted.height)};
}

TruePath::TruePath(TrackedCamera camera, const fs::path& take, const capture::SourceInfo& info,
                   const RigCamera& rig)
    : poses_of_frames_(info.true_poses) {
  if (camera != TrackedCamera::kFisheye) return;
  const fs::path folder = fs::is_directory(take) ? take : take.parent_path();
  auto samples = trajectory::read_samples(folder / kTruthOfFisheye);
  if (!samples) return;
  fisheye_ = *std::move(samples);
  camera_from_target_ = rig.camera_from_target;
}

std::optional<geometry::Pose> TruePath::at(double time_s, const capture::Capture& capture) const {
  constexpr double kSame_s = 1e-6;
  const auto near =
      std::lower_bound(fisheye_.begin(), fisheye_.end(), time_s - kSame_s,
                       [](const trajectory::TimedPose& p, double t) { return p.t_s < t; });
  if (near != fisheye_.end() && near->t_s < time_s + kSame_s)
    return near->world_from_body * camera_from_target_;
  if (time_s == capture.time_s && poses_of_frames_ &&
      capture.pose_origin == capture::PoseOrigin::kRecorded)
    return capture.world_from_target;
  return std::nullopt;
}

}  // namespace mixrig::session
